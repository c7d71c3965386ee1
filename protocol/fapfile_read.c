/* SPDX-License-Identifier: MIT */
#include "protocol/fapfile.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The text, line by line and word by word. */
struct reader {
    const char *at, *end; /* what follows the current line */
    const char *line, *line_end, *word;
    size_t number; /* of the current line, 1-based */
    struct fapfile_error *error;
};

static int fail(struct reader *r, const char *at, const char *message) {
    *r->error = (struct fapfile_error){r->number, (size_t)(at - r->line) + 1, message};
    return -1;
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

/* The next line that is not empty and no comment. */
static bool next_line(struct reader *r) {
    while (r->at < r->end) {
        const char *newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
        r->line = r->word = r->at;
        r->line_end = newline ? newline : r->end;
        r->at = newline ? newline + 1 : r->end;
        r->number++;
        while (r->word < r->line_end && is_blank(*r->word))
            r->word++;
        if (r->word < r->line_end && *r->word != '#')
            return true;
    }
    r->line = r->line_end = r->word = r->end;
    r->number++;
    return false;
}

/* The next word of the line into out (too long a one is cut); false at the line's end. *start = where it stands. */
static bool next_word(struct reader *r, char out[32], const char **start) {
    size_t length = 0;
    while (r->word < r->line_end && is_blank(*r->word))
        r->word++;
    *start = r->word;
    for (; r->word < r->line_end && !is_blank(*r->word); r->word++)
        if (length < 31)
            out[length++] = *r->word;
    out[length] = '\0';
    return length > 0;
}

static int read_number(struct reader *r, double low, double high, double *value) {
    char word[32], *end;
    const char *start;
    if (!next_word(r, word, &start))
        return fail(r, start, "a value is missing");
    *value = strtod(word, &end);
    if (*end || isnan(*value))
        return fail(r, start, "not a number");
    if (isinf(*value))
        *value = 0; /* some tools write -inf for "nothing" */
    if (*value < low || *value > high)
        return fail(r, start, "a value out of range");
    return 0;
}

static int read_bytes(struct reader *r, uint8_t *out, int count) {
    for (int i = 0; i < count; i++) {
        double value;
        if (read_number(r, 0, 255, &value))
            return -1;
        out[i] = (uint8_t)value;
    }
    return 0;
}

static int end_line(struct reader *r, const char *message) {
    char word[32];
    const char *start;
    return next_word(r, word, &start) ? fail(r, start, message) : 0;
}

static int read_mask(struct reader *r, struct fap_frame *f) {
    for (int n = 1; n <= FAP_COUNT; n++) {
        char word[32];
        const char *start;
        if (!next_word(r, word, &start))
            return fail(r, start, "a mask has 68 flags");
        if (strcmp(word, "0") && strcmp(word, "1"))
            return fail(r, start, "a flag is 0 or 1");
        f->mask[(n - 1) / 8] |= (uint8_t)((word[0] - '0') << ((n - 1) % 8));
    }
    return end_line(r, "a mask has 68 flags");
}

static int read_values(struct reader *r, struct fap_frame *f) {
    double value;
    if (read_number(r, 0, 4294967295.0, &value)) /* the frame's number: order tells it already */
        return -1;
    for (int n = 1; n <= FAP_COUNT; n++) {
        int failed = 0;
        if (!fap_frame_has(f, n))
            continue;
        if (n == 1) {
            failed = read_bytes(r, (uint8_t *)&f->viseme, 4);
        } else if (n == 2) {
            failed = read_bytes(r, (uint8_t *)&f->expression, 6);
        } else {
            failed = read_number(r, -2147483647.0, 2147483647.0, &value);
            f->value[n] = (int32_t)value;
        }
        if (failed)
            return -1;
    }
    return end_line(r, "more values than flags");
}

/* Is the current line a mask? Then the file has no header. */
static bool is_mask(struct reader r) {
    char word[32];
    const char *start;
    int flags = 0;
    for (; next_word(&r, word, &start); flags++)
        if (strcmp(word, "0") && strcmp(word, "1"))
            return false;
    return flags == FAP_COUNT;
}

/* "VERSION NAME FPS COUNT"; the name may hold spaces, so the numbers are taken from the right. */
static int read_header(struct reader *r, struct fapfile *file, size_t *count) {
    char word[32], *end;
    const char *start, *last[2] = {NULL, NULL}, *name = NULL;
    if (!next_word(r, word, &start) || (strcmp(word, "2.0") && strcmp(word, "2.1")))
        return fail(r, start, "neither a header of version 2.0 or 2.1 nor a mask of 68 flags");
    memcpy(file->version, word, 4); /* "2.0" or "2.1" */
    while (next_word(r, word, &start)) {
        name = name ? name : start;
        last[0] = last[1];
        last[1] = start;
    }
    if (!last[0] || last[0] == name)
        return fail(r, r->line_end, "a header has version, name, frame rate and number of frames");
    r->word = last[0];
    next_word(r, word, &start);
    file->fps = strtod(word, &end);
    if (*end || !(file->fps > 0 && file->fps <= 1000))
        return fail(r, start, "not a frame rate");
    next_word(r, word, &start);
    *count = strtoull(word, &end, 10);
    if (*end || *word == '-')
        return fail(r, start, "not a number of frames");
    for (end = (char *)last[0]; end > name && is_blank(end[-1]);)
        end--;
    free(file->name);
    file->name = calloc(1, (size_t)(end - name) + 1);
    if (!file->name)
        return fail(r, name, "out of memory");
    memcpy(file->name, name, (size_t)(end - name));
    return 0;
}

static int read_frames(struct reader *r, struct fapfile *file) {
    size_t cap = 0;
    do {
        if (file->count == cap) {
            cap = cap ? cap * 2 : 64;
            struct fap_frame *more = realloc(file->frames, cap * sizeof *more);
            if (!more)
                return fail(r, r->line, "out of memory");
            file->frames = more;
        }
        struct fap_frame *f = &file->frames[file->count];
        memset(f, 0, sizeof *f);
        if (read_mask(r, f))
            return -1;
        if (!next_line(r))
            return fail(r, r->line, "a mask without its values");
        if (read_values(r, f))
            return -1;
        file->count++;
    } while (next_line(r));
    return 0;
}

int fapfile_read(const char *text, size_t size, struct fapfile *out, struct fapfile_error *error) {
    struct reader r = {.at = text, .end = text + size, .line = text, .line_end = text, .word = text, .error = error};
    struct fapfile file = {.fps = 25, .name = calloc(1, 1)};
    size_t count = 0;
    int failed = file.name ? 0 : fail(&r, text, "out of memory");
    bool some = next_line(&r);
    if (!failed && !some)
        failed = fail(&r, r.line, "nothing but comments");
    bool headless = some && is_mask(r);
    if (!failed && !headless) {
        failed = read_header(&r, &file, &count);
        some = next_line(&r);
    }
    if (!failed && some)
        failed = read_frames(&r, &file);
    if (!failed && !headless && file.count < count)
        failed = fail(&r, r.line, "fewer frames than the header states");
    if (failed)
        fapfile_free(&file);
    else
        *out = file;
    return failed;
}

void fapfile_free(struct fapfile *file) {
    free(file->name);
    free(file->frames);
    *file = (struct fapfile){0};
}
