/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The affects that a text can name, from the expressions file (models/expressions.json): their aliases and
 * their coordinates in the activation-evaluation space. */
#ifndef FACCIA_MARKUP_AFFECTS_H
#define FACCIA_MARKUP_AFFECTS_H

#include <stdbool.h>
#include <stddef.h>

struct affect {
    const char *name;
    char *const *aliases;          /* NULL-terminated; may be NULL */
    double activation, evaluation; /* -1..1; both 0: no coordinates */
    bool basic;                    /* one of the six basic emotions */
};

/* In the order of the file. Whoever passes it to a reader owns it and keeps it alive while the reader
 * runs. */
struct affects {
    const struct affect *items;
    size_t count;
};

/* Finds an affect by its name or else an alias, ignoring case. Returns NULL if it is unknown or affects is
 * NULL. */
const struct affect *affect_find(const struct affects *affects, const char *name);

/* Returns the canonical name of an affect; an unknown name is returned unchanged. */
const char *affect_meant(const struct affects *affects, const char *name);

/* Returns the affect in the given direction (both coordinates -1..1) and sets *intensity to the distance
 * from the neutral centre, at most 1. A basic emotion wins if it lies within about 14 degrees of the
 * nearest affect; of several in the same direction, the first wins. Returns NULL at the centre, and if no
 * affect has coordinates. */
const char *affect_at(const struct affects *affects, double activation, double evaluation, double *intensity);

#endif
