/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- lines and words ---- */

/* The current line, without its end, and the position of its next word. */
struct reader {
    const char *text, *limit; /* the rest of the file */
    const char *line, *line_end, *at;
    size_t line_number;
    struct fapfile_error *error;
    bool (*stop)(void *ctx); /* NULL: never */
    void *ctx;
    bool stopped;
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

/* Reports an error at `at` in the current line. Returns -1. */
static int fail(struct reader *r, const char *at, const char *message) {
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

/* Advances to the next line that is neither blank nor a comment, and to its first word. At the end of the
 * file the position is the beginning of the line that would follow. */
static bool next_content(struct reader *r) {
    while (!r->stopped && next_line(r)) {
        r->stopped = r->stop && r->stop(r->ctx);
        if (r->stopped)
            break;
        skip_space(r);
        if (r->at < r->line_end && *r->at != '#')
            return true;
    }
    r->line = r->line_end = r->at = r->limit;
    r->line_number++;
    return false;
}

/* Returns the next word of the line; size 0 at its end. */
static struct word next_word(struct reader *r) {
    skip_space(r);
    struct word w = {r->at, 0};
    while (r->at < r->line_end && !is_space(*r->at))
        r->at++;
    w.size = (size_t)(r->at - w.at);
    return w;
}

/* Parses [+-]DIGITS[.DIGITS]. Returns false if the word is not a number. Not strtod, which depends on the
 * locale and needs a NUL. */
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

/* ---- reading ---- */

static int read_value(struct reader *r, double min, double max, const char *range, double *value) {
    struct word w = next_word(r);
    if (!w.size)
        return fail(r, w.at, "fewer values than the mask has flags");
    if (is_infinite(w)) {
        *value = 0; /* what some tools write for "nothing" */
        return 0;
    }
    if (!parse_number(w, value))
        return fail(r, w.at, "this is no number");
    *value = nearbyint(*value);
    return *value < min || *value > max ? fail(r, w.at, range) : 0;
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

/* Greta writes a 69th flag, always 0, although there are only 68 FAPs. */
static int read_further_flags(struct reader *r, struct fapfile *file) {
    struct word extra = next_word(r);
    if (!extra.size)
        return 0;
    if (!is_flag(extra))
        return fail(r, extra.at, "a mask flag must be 0 or 1");
    if (*extra.at == '1')
        return fail(r, extra.at, "the 69th flag must be 0: there are 68 FAPs");
    struct word more = next_word(r);
    if (more.size)
        return fail(r, more.at, "more than 69 mask flags");
    if (!file->note.message)
        file->note = (struct fapfile_error){r->line_number, (size_t)(extra.at - r->line) + 1,
                                            "69 flags, the last is ignored"};
    return 0;
}

static int read_mask(struct reader *r, struct fapfile *file, struct fap_frame *frame) {
    for (int n = 1; n <= FAP_COUNT; n++) {
        struct word w = next_word(r);
        if (!w.size)
            return fail(r, w.at, "fewer than 68 mask flags");
        if (!is_flag(w))
            return fail(r, w.at, "a mask flag must be 0 or 1");
        if (*w.at == '1')
            fap_frame_set(frame, n, 0);
    }
    return read_further_flags(r, file);
}

static int read_values(struct reader *r, struct fap_frame *frame) {
    struct word number = next_word(r);
    for (size_t i = 0; i < number.size; i++)
        if (!is_digit(number.at[i]))
            return fail(r, number.at, "the values must begin with the number of the frame");
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
    return more.size ? fail(r, more.at, "more values than the mask has flags") : 0;
}

/* Returns the last word before `end`; its size is 0 if the line has none. */
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
        return fail(r, version.at, "neither a header of version 2.0 or 2.1 nor a mask");
    skip_space(r);
    bool number = parse_number(fps, &file->fps);
    if (!fps.size || (fps.at == r->at && !number))
        return fail(r, r->line_end, "the header ends before frame rate and number of frames");
    if (!number || !(file->fps > 0 && file->fps <= FAPFILE_FPS_MAX))
        return fail(r, fps.at, "the frame rate must be a number over 0 and at most 1000");
    if (!parse_number(count, stated) || *stated < 0 || *stated > UINT32_MAX || *stated != floor(*stated))
        return fail(r, count.at, "this is no number of frames");
    const char *end = fps.at;
    while (end > r->at && is_space(end[-1]))
        end--;
    const char *nul = memchr(r->at, '\0', (size_t)(end - r->at));
    if (nul)
        return fail(r, nul, "the name holds a NUL character");
    memcpy(file->version, version.at, version.size);
    memcpy(file->name, r->at, (size_t)(end - r->at)); /* into room for the whole line, zeroed */
    return 0;
}

/* Parses a header without a version: COUNT or FPS COUNT. Returns false for any other line. */
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
        return fail(r, r->at, "the file ends before the values of a mask");
    return read_values(r, frame);
}

static int read_all(struct reader *r, struct fapfile *file) {
    if (!next_content(r))
        return fail(r, r->at, "the file is empty");
    struct reader ahead = *r;
    struct word first = next_word(&ahead);
    bool header = !is_flag(first);
    size_t cap = 0;
    double stated = 0;
    file->fps = 25;
    file->name = calloc(1, (size_t)(r->line_end - r->line) + 1);
    if (!file->name)
        return fail(r, r->line, "out of memory");
    bool bare = read_bare_header(r, file, &stated);
    if (header && !bare && read_header(r, file, &stated))
        return -1;
    for (bool more = !(header || bare) || next_content(r); more; more = next_content(r)) {
        struct fap_frame frame;
        if (read_frame(r, file, &frame))
            return -1;
        if (add_frame(file, &cap, &frame))
            return fail(r, r->line, "out of memory");
    }
    return (double)file->count < stated ? fail(r, r->at, "fewer frames than the header states") : 0;
}

int fapfile_read(const char *text, size_t size, struct fapfile *out, struct fapfile_error *error) {
    return fapfile_read_until(text, size, NULL, NULL, out, error);
}

int fapfile_read_until(const char *text, size_t size, bool (*stop)(void *ctx), void *ctx, struct fapfile *out,
                       struct fapfile_error *error) {
    static const char byte_order_mark[] = {'\xEF', '\xBB', '\xBF'};
    size_t skip = size >= 3 && !memcmp(text, byte_order_mark, 3) ? 3 : 0;
    struct reader r = {.text = text + skip, .limit = text + size, .error = error, .stop = stop, .ctx = ctx};
    struct fapfile file = {0};
    if (read_all(&r, &file) || r.stopped) {
        if (r.stopped)
            fail(&r, r.at, "stopped");
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

/* ---- writing ---- */

/* Prints as snprintf does: counts everything, stores what fits. Free of the locale, which could turn 29.97
 * into 29,97. */
struct printer {
    char *out;
    size_t cap, length;
};

static void put(struct printer *p, char c) {
    if (p->length + 1 < p->cap)
        p->out[p->length] = c;
    p->length++;
}

static size_t end(struct printer *p) {
    if (p->cap)
        p->out[p->length < p->cap ? p->length : p->cap - 1] = '\0';
    return p->length;
}

static void put_text(struct printer *p, const char *text) {
    while (*text)
        put(p, *text++);
}

static void put_unsigned(struct printer *p, uint64_t value) {
    char digits[20];
    int count = 0;
    do
        digits[count++] = (char)('0' + value % 10);
    while (value /= 10);
    while (count)
        put(p, digits[--count]);
}

static void put_value(struct printer *p, int64_t value) {
    put(p, ' ');
    if (value < 0)
        put(p, '-');
    put_unsigned(p, value < 0 ? (uint64_t)-value : (uint64_t)value);
}

static void put_fps(struct printer *p, double fps) {
    uint64_t millionths = fps > 0 && fps <= FAPFILE_FPS_MAX ? (uint64_t)fmax(1, round(fps * 1e6)) : 0;
    put_unsigned(p, millionths / 1000000);
    uint64_t rest = millionths % 1000000;
    if (!rest)
        return;
    put(p, '.');
    for (uint64_t place = 100000; rest; rest %= place, place /= 10)
        put(p, (char)('0' + rest / place));
}

size_t fapfile_write_header(const char *name, double fps, size_t count, char *out, size_t cap) {
    struct printer p = {out, cap, 0};
    put_text(&p, "2.1 ");
    for (; *name; name++)
        put(&p, (unsigned char)*name < ' ' ? ' ' : *name); /* a line break would end the header */
    put(&p, ' ');
    put_fps(&p, fps);
    put(&p, ' ');
    put_unsigned(&p, count);
    put(&p, '\n');
    return end(&p);
}

size_t fapfile_write_frame(const struct fap_frame *frame, size_t frame_number, char *out, size_t cap) {
    struct printer p = {out, cap, 0};
    for (int n = 1; n <= FAP_COUNT; n++) {
        if (n > 1)
            put(&p, ' ');
        put(&p, fap_frame_has(frame, n) ? '1' : '0');
    }
    put(&p, '\n');
    put_unsigned(&p, frame_number);
    const struct fap_viseme *v = &frame->viseme;
    const struct fap_expression *e = &frame->expression;
    const uint8_t viseme[] = {v->select1, v->select2, v->blend, v->def};
    const uint8_t expression[] = {e->select1, e->intensity1, e->select2, e->intensity2, e->init_face, e->def};
    for (size_t i = 0; i < sizeof viseme && fap_frame_has(frame, 1); i++)
        put_value(&p, viseme[i]);
    for (size_t i = 0; i < sizeof expression && fap_frame_has(frame, 2); i++)
        put_value(&p, expression[i]);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(frame, n))
            put_value(&p, frame->value[n]);
    put(&p, '\n');
    return end(&p);
}
