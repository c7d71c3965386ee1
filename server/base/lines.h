/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines and columns of byte offsets, both counted from 1, columns in characters. */
#ifndef FACCIA_BASE_LINES_H
#define FACCIA_BASE_LINES_H

#include <stddef.h>

/* Remembers where it was: the next place costs its distance from there. Begins zeroed. */
struct lines {
    size_t byte;         /* the place last asked for */
    size_t line, column; /* counted from 0 */
};

/* The place of s[byte]; byte <= the length of s, which is one text for the life of the counter. */
void lines_place(struct lines *lines, const char *s, size_t byte, size_t *line, size_t *column);

#endif
