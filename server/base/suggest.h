/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What somebody may have meant: the names on offer that are nearest to one that is not. */
#ifndef FACCIA_BASE_NEAR_H
#define FACCIA_BASE_NEAR_H

#include <stddef.h>

enum { SUGGESTIONS_MAX = 3, SUGGESTIONS_TEXT = 256 };

struct suggestions {
    const char *wanted;
    const char *names[SUGGESTIONS_MAX]; /* nearest first */
    unsigned distances[SUGGESTIONS_MAX];
    size_t count;
};

/* Begins with the name that is not there; it and the names below are borrowed. */
struct suggestions suggestions_for(const char *wanted);

/* Tries a name; what is told of it, when it is near, is `shown`. Distance is the number of letters put in,
 * left out, replaced or swapped with the next (optimal string alignment), without regard to case. */
void suggest_name(struct suggestions *near, const char *name, const char *shown);
void suggest_names(struct suggestions *near, const char *const *names); /* NULL-terminated */

/* "; near: a, b", or "" when nothing is: the end of a message. Returns out. */
const char *suggestions_text(const struct suggestions *near, char out[SUGGESTIONS_TEXT]);

#endif
