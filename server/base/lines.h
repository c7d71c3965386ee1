/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts byte offsets to line and column, both from 1; columns are in characters. */
#ifndef FACCIA_BASE_LINES_H
#define FACCIA_BASE_LINES_H

#include <stddef.h>

/* Caches the last position: finding the next one costs the distance between them. Begins zeroed. */
struct lines {
    size_t byte;         /* last position */
    size_t line, column; /* 0-based */
};

/* Line and column of s[byte]. byte is at most the length of s, which must be the same text in every call. */
void lines_place(struct lines *lines, const char *s, size_t byte, size_t *line, size_t *column);

#endif
