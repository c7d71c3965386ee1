/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Line and column of byte offsets, both from 1, columns in characters. */
#ifndef FACCIA_BASE_LINES_H
#define FACCIA_BASE_LINES_H

#include <stddef.h>

/* Remembers the last place: the next one costs the distance from there. Begins zeroed. */
struct lines {
    size_t byte;         /* last place */
    size_t line, column; /* counted from 0 */
};

/* Place of s[byte]; byte <= length of s, which must be the same text for every call. */
void lines_place(struct lines *lines, const char *s, size_t byte, size_t *line, size_t *column);

#endif
