/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What somebody may have meant: the names on offer that are nearest to one that is not. */
#ifndef FACCIA_BASE_NEAR_H
#define FACCIA_BASE_NEAR_H

#include <stddef.h>

enum { NEAR_MOST = 3, NEAR_TEXT = 256 };

struct near {
    const char *wanted;
    const char *names[NEAR_MOST]; /* nearest first */
    unsigned distances[NEAR_MOST];
    size_t count;
};

/* Begins with the name that is not there; it and the names below are borrowed. */
struct near near_to(const char *wanted);

/* Tries a name; what is told of it, when it is near, is `shown`. Distance is the number of letters put in,
 * left out, replaced or swapped with the next (optimal string alignment), without regard to case. */
void near_try(struct near *near, const char *name, const char *shown);
void near_try_all(struct near *near, const char *const *names); /* NULL-terminated */

/* "; near: a, b", or "" when nothing is: the end of a message. Returns out. */
const char *near_text(const struct near *near, char out[NEAR_TEXT]);

#endif
