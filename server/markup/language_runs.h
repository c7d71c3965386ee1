/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stretches of a plain text in other languages, given by a request as "START-END:LANG" in UTF-16 units,
 * separated by spaces. */
#ifndef FACCIA_MARKUP_LANGUAGE_RUNS_H
#define FACCIA_MARKUP_LANGUAGE_RUNS_H

#include "server/base/error.h"
#include <stddef.h>

enum { LANGUAGE_BYTES = 36 };

struct language_run {
    size_t from, to; /* bytes of the text */
    char lang[LANGUAGE_BYTES];
};

/* Ascending, without overlaps. Zeroed: empty. */
struct language_runs {
    struct language_run *list;
    size_t count, cap;
};

/* Parses `written` for text[0..size), which is well-formed UTF-8. Where ranges overlap, the one that begins
 * later wins; bytes beyond the end of the text are ignored. Returns -1 with *e: "bad-field" in "languages".
 */
int language_runs_read(struct language_runs *runs, const char *written, const char *text, size_t size,
                       struct error *e);
void language_runs_free(struct language_runs *runs);

#endif
