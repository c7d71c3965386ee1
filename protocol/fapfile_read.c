/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int read_value(struct fapfile_reader *r, double min, double max, const char *range, double *value) {
    struct fapfile_word w = fapfile_next_word(r);
    if (!w.size)
        return fapfile_wrong(r, w.at, "fewer values than the mask has flags");
    if (fapfile_is_infinite(w)) {
        *value = 0; /* what some tools write for "nothing" */
        return 0;
    }
    if (!fapfile_parse_number(w, value))
        return fapfile_wrong(r, w.at, "this is no number");
    *value = nearbyint(*value);
    return *value < min || *value > max ? fapfile_wrong(r, w.at, range) : 0;
}

static int read_small(struct fapfile_reader *r, size_t count, uint8_t *out) {
    for (size_t i = 0; i < count; i++) {
        double value;
        if (read_value(r, 0, UINT8_MAX, "a value of FAP 1 or 2 must be 0 to 255", &value))
            return -1;
        out[i] = (uint8_t)value;
    }
    return 0;
}

static bool is_flag(struct fapfile_word w) {
    return w.size == 1 && (*w.at == '0' || *w.at == '1');
}

/* Greta writes a 69th flag, always 0, although there are only 68 FAPs. */
static int read_further_flags(struct fapfile_reader *r, struct fapfile *file) {
    struct fapfile_word extra = fapfile_next_word(r);
    if (!extra.size)
        return 0;
    if (!is_flag(extra))
        return fapfile_wrong(r, extra.at, "a mask flag must be 0 or 1");
    if (*extra.at == '1')
        return fapfile_wrong(r, extra.at, "the 69th flag must be 0: there are 68 FAPs");
    struct fapfile_word more = fapfile_next_word(r);
    if (more.size)
        return fapfile_wrong(r, more.at, "more than 69 mask flags");
    if (!file->note.message)
        file->note = (struct fapfile_error){r->line_number, (size_t)(extra.at - r->line) + 1,
                                            "69 flags, the last is ignored"};
    return 0;
}

static int read_mask(struct fapfile_reader *r, struct fapfile *file, struct fap_frame *frame) {
    for (int n = 1; n <= FAP_COUNT; n++) {
        struct fapfile_word w = fapfile_next_word(r);
        if (!w.size)
            return fapfile_wrong(r, w.at, "fewer than 68 mask flags");
        if (!is_flag(w))
            return fapfile_wrong(r, w.at, "a mask flag must be 0 or 1");
        if (*w.at == '1')
            fap_frame_set(frame, n, 0);
    }
    return read_further_flags(r, file);
}

static int read_values(struct fapfile_reader *r, struct fap_frame *frame) {
    struct fapfile_word number = fapfile_next_word(r);
    for (size_t i = 0; i < number.size; i++)
        if (!fapfile_is_digit(number.at[i]))
            return fapfile_wrong(r, number.at, "the values must begin with the number of the frame");
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
    struct fapfile_word more = fapfile_next_word(r);
    return more.size ? fapfile_wrong(r, more.at, "more values than the mask has flags") : 0;
}

/* Returns the last word before `end`; size 0 if there is none. */
static struct fapfile_word last_word(const char *begin, const char *end) {
    while (end > begin && fapfile_is_space(end[-1]))
        end--;
    const char *at = end;
    while (at > begin && !fapfile_is_space(at[-1]))
        at--;
    return (struct fapfile_word){at, (size_t)(end - at)};
}

/* VERSION NAME FPS COUNT. The name may hold spaces, so the numbers are taken from the right; it may be
 * missing too. */
static int read_header(struct fapfile_reader *r, struct fapfile *file, double *stated) {
    struct fapfile_word version = fapfile_next_word(r);
    struct fapfile_word count = last_word(r->at, r->line_end), fps = last_word(r->at, count.at);
    if (version.size != 3 || (memcmp(version.at, "2.0", 3) && memcmp(version.at, "2.1", 3)))
        return fapfile_wrong(r, version.at, "neither a header of version 2.0 or 2.1 nor a mask");
    fapfile_skip_space(r);
    bool number = fapfile_parse_number(fps, &file->fps);
    if (!fps.size || (fps.at == r->at && !number))
        return fapfile_wrong(r, r->line_end, "the header ends before frame rate and number of frames");
    if (!number || !(file->fps > 0 && file->fps <= FAPFILE_FPS_MAX))
        return fapfile_wrong(r, fps.at, "the frame rate must be a number over 0 and at most 1000");
    if (!fapfile_parse_number(count, stated) || *stated < 0 || *stated > UINT32_MAX ||
        *stated != floor(*stated))
        return fapfile_wrong(r, count.at, "this is no number of frames");
    const char *end = fps.at;
    while (end > r->at && fapfile_is_space(end[-1]))
        end--;
    const char *nul = memchr(r->at, '\0', (size_t)(end - r->at));
    if (nul)
        return fapfile_wrong(r, nul, "the name holds a NUL character");
    memcpy(file->version, version.at, version.size);
    memcpy(file->name, r->at, (size_t)(end - r->at)); /* into room for the whole line, zeroed */
    return 0;
}

/* Parses a header without a version: COUNT or FPS COUNT. Returns false for any other line. */
static bool read_bare_header(struct fapfile_reader *r, struct fapfile *file, double *stated) {
    struct fapfile_reader ahead = *r;
    double fps = file->fps;
    struct fapfile_word first = fapfile_next_word(&ahead), second = fapfile_next_word(&ahead),
                        count = second.size ? second : first;
    if (fapfile_next_word(&ahead).size || (second.size && !fapfile_parse_number(first, &fps)))
        return false;
    for (size_t i = 0; i < count.size; i++)
        if (!fapfile_is_digit(count.at[i]))
            return false;
    if (!(fps > 0 && fps <= FAPFILE_FPS_MAX) || !fapfile_parse_number(count, stated) || *stated > UINT32_MAX)
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

static int read_frame(struct fapfile_reader *r, struct fapfile *file, struct fap_frame *frame) {
    *frame = (struct fap_frame){0};
    if (read_mask(r, file, frame))
        return -1;
    if (!fapfile_next_content(r))
        return fapfile_wrong(r, r->at, "the file ends before the values of a mask");
    return read_values(r, frame);
}

static int read_all(struct fapfile_reader *r, struct fapfile *file) {
    if (!fapfile_next_content(r))
        return fapfile_wrong(r, r->at, "the file is empty");
    struct fapfile_reader ahead = *r;
    struct fapfile_word first = fapfile_next_word(&ahead);
    bool header = !is_flag(first);
    size_t cap = 0;
    double stated = 0;
    file->fps = 25;
    file->name = calloc(1, (size_t)(r->line_end - r->line) + 1);
    if (!file->name)
        return fapfile_wrong(r, r->line, "out of memory");
    bool bare = read_bare_header(r, file, &stated);
    if (header && !bare && read_header(r, file, &stated))
        return -1;
    for (bool more = !(header || bare) || fapfile_next_content(r); more; more = fapfile_next_content(r)) {
        struct fap_frame frame;
        if (read_frame(r, file, &frame))
            return -1;
        if (add_frame(file, &cap, &frame))
            return fapfile_wrong(r, r->line, "out of memory");
    }
    return (double)file->count < stated ? fapfile_wrong(r, r->at, "fewer frames than the header states") : 0;
}

int fapfile_read(const char *text, size_t size, struct fapfile *out, struct fapfile_error *error) {
    return fapfile_read_until(text, size, NULL, NULL, out, error);
}

int fapfile_read_until(const char *text, size_t size, bool (*stop)(void *ctx), void *ctx, struct fapfile *out,
                       struct fapfile_error *error) {
    static const char byte_order_mark[] = {'\xEF', '\xBB', '\xBF'};
    size_t skip = size >= 3 && !memcmp(text, byte_order_mark, 3) ? 3 : 0;
    struct fapfile_reader r = {
        .text = text + skip, .limit = text + size, .error = error, .stop = stop, .ctx = ctx};
    struct fapfile file = {0};
    if (read_all(&r, &file) || r.stopped) {
        if (r.stopped)
            fapfile_wrong(&r, r.at, "stopped");
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
