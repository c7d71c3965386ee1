/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The affects that a text can name, as the expressions file has them (models/expressions.json): their other
 * names, and their places on the disc of activation and evaluation. */
#ifndef FACCIA_MARKUP_AFFECTS_H
#define FACCIA_MARKUP_AFFECTS_H

#include <stdbool.h>
#include <stddef.h>

struct affect {
    const char *name;
    char *const *aliases;          /* NULL-terminated; may be NULL */
    double activation, evaluation; /* -1..1; both 0: it has no place */
    bool basic;                    /* one of the six basic emotions */
};

/* In the order of the file. Who gives it to a reader owns it, and keeps it as long as it reads. */
struct affects {
    const struct affect *items;
    size_t count;
};

/* The affect of that name, or the one that has it as an alias (any case); NULL when there is none. affects
 * may be NULL: then there are none. */
const struct affect *affect_find(const struct affects *affects, const char *name);

/* The name of the affect that is meant; the name itself when there is none. */
const char *affect_meant(const struct affects *affects, const char *name);

/* The affect that lies in that direction; both -1..1. *intensity is the distance from the neutral middle, at
 * most 1. The basic emotions are taken where they lie within about 14 degrees of the nearest; of several in
 * one direction the first. NULL in the middle, and when no affect has a place. */
const char *affect_at(const struct affects *affects, double activation, double evaluation, double *intensity);

#endif
