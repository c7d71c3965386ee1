/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The line that is being read, without its end, and where in it the next word begins. */
struct reader {
    const char *text, *limit; /* what has not been cut into lines yet */
    const char *line, *line_end, *at;
    size_t line_number;
    struct fapfile_error *error;
};

struct word {
    const char *at;
    size_t size;
};

static bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Marks the place `at` in the current line. Returns -1. */
static int wrong(struct reader *r, const char *at, const char *message) {
    *r->error = (struct fapfile_error){r->line_number, (size_t)(at - r->line) + 1, message};
    return -1;
}

/* Lines end with LF, CR LF or CR. */
static bool next_line(struct reader *r) {
    if (r->text == r->limit)
        return false;
    const char *end = r->text;
    while (end < r->limit && *end != '\n' && *end != '\r')
        end++;
    r->line = r->at = r->text;
    r->line_end = end;
    r->line_number++;
    if (end < r->limit && *end++ == '\r' && end < r->limit && *end == '\n')
        end++;
    r->text = end;
    return true;
}

static void skip_space(struct reader *r) {
    while (r->at < r->line_end && is_space(*r->at))
        r->at++;
}

/* The next line that is neither blank nor a comment, from its first word on. At the end of the file the place
 * is the beginning of the line that would follow. */
static bool next_content(struct reader *r) {
    while (next_line(r)) {
        skip_space(r);
        if (r->at < r->line_end && *r->at != '#')
            return true;
    }
    r->line = r->line_end = r->at = r->limit;
    r->line_number++;
    return false;
}

/* The next word of the line; its size is 0 at the end. */
static struct word next_word(struct reader *r) {
    skip_space(r);
    struct word w = {r->at, 0};
    while (r->at < r->line_end && !is_space(*r->at))
        r->at++;
    w.size = (size_t)(r->at - w.at);
    return w;
}

/* [+-]DIGITS[.DIGITS], by hand because strtod goes by the locale and wants a NUL. False when w is none. */
static bool parse_number(struct word w, double *value) {
    size_t i = 0, digits = 0;
    double mantissa = 0, scale = 1;
    bool negative = w.size && w.at[0] == '-';
    if (w.size && (w.at[0] == '-' || w.at[0] == '+'))
        i++;
    for (; i < w.size && is_digit(w.at[i]); i++, digits++)
        mantissa = mantissa * 10 + (w.at[i] - '0');
    if (i < w.size && w.at[i] == '.')
        for (i++; i < w.size && is_digit(w.at[i]); i++, digits++) {
            if (scale >= 1e9)
                continue; /* further decimals change nothing that matters here */
            mantissa = mantissa * 10 + (w.at[i] - '0');
            scale *= 10;
        }
    *value = (negative ? -mantissa : mantissa) / scale;
    return digits && i == w.size;
}

static bool is_infinite(struct word w) {
    if (w.size == 4 && (*w.at == '-' || *w.at == '+'))
        w = (struct word){w.at + 1, 3};
    return w.size == 3 && !memcmp(w.at, "inf", 3);
}

static int read_value(struct reader *r, double min, double max, const char *range, double *value) {
    struct word w = next_word(r);
    if (!w.size)
        return wrong(r, w.at, "fewer values than the mask has flags");
    if (is_infinite(w)) {
        *value = 0; /* what some tools write for "nothing" */
        return 0;
    }
    if (!parse_number(w, value))
        return wrong(r, w.at, "this is no number");
    *value = nearbyint(*value);
    return *value < min || *value > max ? wrong(r, w.at, range) : 0;
}

static int read_small(struct reader *r, size_t count, uint8_t *out) {
    for (size_t i = 0; i < count; i++) {
        double value;
        if (read_value(r, 0, UINT8_MAX, "a value of FAP 1 or 2 must be 0 to 255", &value))
            return -1;
        out[i] = (uint8_t)value;
    }
    return 0;
}

static bool is_flag(struct word w) {
    return w.size == 1 && (*w.at == '0' || *w.at == '1');
}

/* Greta writes a 69th flag, which is always 0: there is no such FAP. */
static int read_further_flags(struct reader *r, struct fapfile *file) {
    struct word extra = next_word(r);
    if (!extra.size)
        return 0;
    if (!is_flag(extra))
        return wrong(r, extra.at, "a mask flag must be 0 or 1");
    if (*extra.at == '1')
        return wrong(r, extra.at, "the 69th flag must be 0: there are 68 FAPs");
    struct word more = next_word(r);
    if (more.size)
        return wrong(r, more.at, "more than 69 mask flags");
    if (!file->note.message)
        file->note = (struct fapfile_error){r->line_number, (size_t)(extra.at - r->line) + 1,
                                            "69 flags, the last is ignored"};
    return 0;
}

static int read_mask(struct reader *r, struct fapfile *file, struct fap_frame *frame) {
    for (int n = 1; n <= FAP_COUNT; n++) {
        struct word w = next_word(r);
        if (!w.size)
            return wrong(r, w.at, "fewer than 68 mask flags");
        if (!is_flag(w))
            return wrong(r, w.at, "a mask flag must be 0 or 1");
        if (*w.at == '1')
            fap_frame_set(frame, n, 0);
    }
    return read_further_flags(r, file);
}

static int read_values(struct reader *r, struct fap_frame *frame) {
    struct word number = next_word(r);
    for (size_t i = 0; i < number.size; i++)
        if (!is_digit(number.at[i]))
            return wrong(r, number.at, "the values must begin with the number of the frame");
    uint8_t v[4], e[6];
    if (fap_frame_has(frame, 1)) {
        if (read_small(r, sizeof v, v))
            return -1;
        frame->viseme = (struct fap_viseme){v[0], v[1], v[2], v[3]};
    }
    if (fap_frame_has(frame, 2)) {
        if (read_small(r, sizeof e, e))
            return -1;
        frame->expression = (struct fap_expression){e[0], e[1], e[2], e[3], e[4], e[5]};
    }
    for (int n = 3; n <= FAP_COUNT; n++) {
        double value;
        if (!fap_frame_has(frame, n))
            continue;
        if (read_value(r, INT32_MIN, INT32_MAX, "a value must fit 32 bits", &value))
            return -1;
        frame->value[n] = (int32_t)value;
    }
    struct word more = next_word(r);
    return more.size ? wrong(r, more.at, "more values than the mask has flags") : 0;
}

/* The last word before `end`; its size is 0 when there is none. */
static struct word last_word(const char *begin, const char *end) {
    while (end > begin && is_space(end[-1]))
        end--;
    const char *at = end;
    while (at > begin && !is_space(at[-1]))
        at--;
    return (struct word){at, (size_t)(end - at)};
}

/* VERSION NAME FPS COUNT. The name may hold spaces, so the numbers are taken from the right; it may be
 * missing too. */
static int read_header(struct reader *r, struct fapfile *file, double *stated) {
    struct word version = next_word(r);
    struct word count = last_word(r->at, r->line_end), fps = last_word(r->at, count.at);
    if (version.size != 3 || (memcmp(version.at, "2.0", 3) && memcmp(version.at, "2.1", 3)))
        return wrong(r, version.at, "neither a header of version 2.0 or 2.1 nor a mask");
    skip_space(r);
    bool number = parse_number(fps, &file->fps);
    if (!fps.size || (fps.at == r->at && !number))
        return wrong(r, r->line_end, "the header ends before frame rate and number of frames");
    if (!number || !(file->fps > 0 && file->fps <= FAPFILE_FPS_MAX))
        return wrong(r, fps.at, "the frame rate must be a number over 0 and at most 1000");
    if (!parse_number(count, stated) || *stated < 0 || *stated > UINT32_MAX || *stated != floor(*stated))
        return wrong(r, count.at, "this is no number of frames");
    const char *end = fps.at;
    while (end > r->at && is_space(end[-1]))
        end--;
    const char *nul = memchr(r->at, '\0', (size_t)(end - r->at));
    if (nul)
        return wrong(r, nul, "the name holds a NUL character");
    memcpy(file->version, version.at, version.size);
    memcpy(file->name, r->at, (size_t)(end - r->at)); /* into room for the whole line, zeroed */
    return 0;
}

/* A first line without a version: COUNT alone, or FPS COUNT. False when it is none of the two. */
static bool read_bare_header(struct reader *r, struct fapfile *file, double *stated) {
    struct reader ahead = *r;
    double fps = file->fps;
    struct word first = next_word(&ahead), second = next_word(&ahead), count = second.size ? second : first;
    if (next_word(&ahead).size || (second.size && !parse_number(first, &fps)))
        return false;
    for (size_t i = 0; i < count.size; i++)
        if (!is_digit(count.at[i]))
            return false;
    if (!(fps > 0 && fps <= FAPFILE_FPS_MAX) || !parse_number(count, stated) || *stated > UINT32_MAX)
        return false;
    file->fps = fps;
    return true;
}

static int add_frame(struct fapfile *file, size_t *cap, const struct fap_frame *frame) {
    if (file->count == *cap) {
        size_t more = *cap ? *cap * 2 : 64;
        if (more > SIZE_MAX / sizeof *frame)
            return -1;
        struct fap_frame *frames = realloc(file->frames, more * sizeof *frame);
        if (!frames)
            return -1;
        file->frames = frames;
        *cap = more;
    }
    file->frames[file->count++] = *frame;
    return 0;
}

static int read_frame(struct reader *r, struct fapfile *file, struct fap_frame *frame) {
    *frame = (struct fap_frame){0};
    if (read_mask(r, file, frame))
        return -1;
    if (!next_content(r))
        return wrong(r, r->at, "the file ends before the values of a mask");
    return read_values(r, frame);
}

static int read_all(struct reader *r, struct fapfile *file) {
    if (!next_content(r))
        return wrong(r, r->at, "the file is empty");
    struct reader ahead = *r;
    struct word first = next_word(&ahead);
    bool header = !is_flag(first);
    size_t cap = 0;
    double stated = 0;
    file->fps = 25;
    file->name = calloc(1, (size_t)(r->line_end - r->line) + 1);
    if (!file->name)
        return wrong(r, r->line, "out of memory");
    bool bare = read_bare_header(r, file, &stated);
    if (header && !bare && read_header(r, file, &stated))
        return -1;
    for (bool more = !(header || bare) || next_content(r); more; more = next_content(r)) {
        struct fap_frame frame;
        if (read_frame(r, file, &frame))
            return -1;
        if (add_frame(file, &cap, &frame))
            return wrong(r, r->line, "out of memory");
    }
    return (double)file->count < stated ? wrong(r, r->at, "fewer frames than the header states") : 0;
}

int fapfile_read(const char *text, size_t size, struct fapfile *out, struct fapfile_error *error) {
    static const char byte_order_mark[] = {'\xEF', '\xBB', '\xBF'};
    size_t skip = size >= 3 && !memcmp(text, byte_order_mark, 3) ? 3 : 0;
    struct reader r = {.text = text + skip, .limit = text + size, .error = error};
    struct fapfile file = {0};
    if (read_all(&r, &file)) {
        fapfile_free(&file);
        return -1;
    }
    *out = file;
    return 0;
}

void fapfile_free(struct fapfile *file) {
    free(file->name);
    free(file->frames);
    *file = (struct fapfile){0};
}
