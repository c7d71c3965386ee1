/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/suggest.h"
#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { NAME_MOST = 64, FAR = 1000, PREFIX_LEAST = 3 };

static unsigned least(unsigned a, unsigned b) {
    return a < b ? a : b;
}

static char at(const char *text, size_t i) {
    return (char)tolower((unsigned char)text[i]);
}

/* Three rows of the table suffice, as a swap looks back two. */
static unsigned distance(const char *a, const char *b) {
    unsigned rows[3][NAME_MOST + 1];
    size_t n = strlen(a), m = strlen(b);
    if (n > NAME_MOST || m > NAME_MOST)
        return FAR;
    for (size_t j = 0; j <= m; j++)
        rows[0][j] = (unsigned)j;
    for (size_t i = 1; i <= n; i++) {
        unsigned *row = rows[i % 3], *last = rows[(i + 2) % 3], *before = rows[(i + 1) % 3];
        row[0] = (unsigned)i;
        for (size_t j = 1; j <= m; j++) {
            row[j] = least(last[j], row[j - 1]) + 1;
            row[j] = least(row[j], last[j - 1] + (at(a, i - 1) != at(b, j - 1)));
            if (i > 1 && j > 1 && at(a, i - 1) == at(b, j - 2) && at(a, i - 2) == at(b, j - 1))
                row[j] = least(row[j], before[j - 2] + 1);
        }
    }
    return rows[n % 3][m];
}

/* Largest accepted distance for a name of this length. */
static unsigned farthest(size_t length) {
    return length < 4 ? 1 : length < 8 ? 2 : 3;
}

struct suggestions suggestions_for(const char *wanted) {
    return (struct suggestions){.wanted = wanted};
}

void suggest_name(struct suggestions *s, const char *name, const char *shown) {
    size_t length = strlen(s->wanted);
    unsigned far = distance(s->wanted, name), limit = farthest(length);
    if (length >= PREFIX_LEAST && !strncasecmp(s->wanted, name, length))
        far = least(far, limit);
    if (!length || far > limit)
        return;
    for (size_t i = 0; i < s->count; i++)
        if (!strcmp(s->names[i], shown))
            return;
    size_t place = s->count < SUGGESTIONS_MAX ? s->count++ : SUGGESTIONS_MAX;
    while (place && s->distances[place - 1] > far) {
        if (place < SUGGESTIONS_MAX) {
            s->names[place] = s->names[place - 1];
            s->distances[place] = s->distances[place - 1];
        }
        place--;
    }
    if (place < SUGGESTIONS_MAX) {
        s->names[place] = shown;
        s->distances[place] = far;
    }
}

void suggest_names(struct suggestions *s, const char *const *names) {
    for (; names && *names; names++)
        suggest_name(s, *names, *names);
}

const char *suggestions_text(const struct suggestions *s, char out[SUGGESTIONS_TEXT]) {
    size_t used = 0;
    *out = '\0';
    for (size_t i = 0; i < s->count && used < SUGGESTIONS_TEXT; i++)
        used +=
            (size_t)snprintf(out + used, SUGGESTIONS_TEXT - used, "%s%s", i ? ", " : "; near: ", s->names[i]);
    return out;
}
