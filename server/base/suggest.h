/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggests names for a misspelt one ("did you mean"). */
#ifndef FACCIA_BASE_SUGGEST_H
#define FACCIA_BASE_SUGGEST_H

#include <stddef.h>

enum { SUGGESTIONS_MAX = 3, SUGGESTIONS_TEXT = 256 };

struct suggestions {
    const char *wanted;
    const char *names[SUGGESTIONS_MAX]; /* closest first */
    unsigned distances[SUGGESTIONS_MAX];
    size_t count;
};

/* Starts the search for an unknown name. The name and the candidates are borrowed. */
struct suggestions suggestions_for(const char *wanted);

/* Tries a candidate, to be suggested as `shown`. The distance counts letters inserted, deleted, replaced
 * or swapped with the next one (optimal string alignment), ignoring case. */
void suggest_name(struct suggestions *s, const char *name, const char *shown);
void suggest_names(struct suggestions *s, const char *const *names); /* NULL-terminated */

/* Formats "; near: a, b" for the end of a message, or "" if nothing is close. Returns out. */
const char *suggestions_text(const struct suggestions *s, char out[SUGGESTIONS_TEXT]);

#endif
