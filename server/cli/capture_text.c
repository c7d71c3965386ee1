/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/capture_text.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER_MAX = 63 };

static void find_line_end(struct capture_text *t) {
    const char *end = memchr(t->at, '\n', (size_t)(t->end - t->at));
    t->line_end = end ? end : t->end;
}

struct capture_text capture_text_begin(const char *text, size_t size, struct capture_error *error) {
    struct capture_text t = {.at = text, .end = text + size, .line_start = text, .line = 1, .error = error};
    if (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3))
        t.at += 3;
    find_line_end(&t);
    return t;
}

bool capture_text_next(struct capture_text *t) {
    do {
        t->at = t->line_end < t->end ? t->line_end + 1 : t->end;
        if (t->at == t->end)
            return false;
        t->line_start = t->at;
        t->line++;
        find_line_end(t);
    } while (t->line_end == t->at || *t->at == '\r');
    return true;
}

const char *capture_text_field(struct capture_text *t, size_t *length) {
    if (t->at > t->line_end)
        return NULL;
    const char *field = t->at, *comma = memchr(field, ',', (size_t)(t->line_end - field));
    const char *end = comma ? comma : t->line_end;
    t->at = end + 1;
    while (end > field && (end[-1] == '\r' || end[-1] == ' '))
        end--;
    *length = (size_t)(end - field);
    return field;
}

int capture_text_number(struct capture_text *t, const char *field, size_t length, double *out) {
    char word[NUMBER_MAX + 1], *end;
    if (!length || length > NUMBER_MAX)
        return capture_text_fail(t, field, "this is no number");
    memcpy(word, field, length);
    word[length] = '\0';
    *out = strtod(word, &end);
    return !*end && isfinite(*out) ? 0 : capture_text_fail(t, field, "this is no number");
}

int capture_text_fail(struct capture_text *t, const char *at, const char *message) {
    size_t column = at ? (size_t)(at - t->line_start) + 1 : 0;
    *t->error = (struct capture_error){t->line, column, message};
    return -1;
}
