/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stretches of a plain text that are in other languages, as a request gives them: "START-END:LANG", in
 * UTF-16 units, parted by spaces. */
#ifndef FACCIA_MARKUP_LANGUAGE_RUNS_H
#define FACCIA_MARKUP_LANGUAGE_RUNS_H

#include "server/base/error.h"
#include <stddef.h>

enum { LANGUAGE_BYTES = 36 };

struct language_run {
    size_t from, to; /* bytes of the text */
    char lang[LANGUAGE_BYTES];
};

/* Rising, and not overlapping. Zeroed: there are none. */
struct language_runs {
    struct language_run *list;
    size_t count, cap;
};

/* Reads what is written of text[0..size), well-formed UTF-8. Of stretches that overlap the one that begins
 * later counts; what lies behind the text is passed over. -1 with *e: "bad-field", "languages". */
int language_runs_read(struct language_runs *runs, const char *written, const char *text, size_t size,
                       struct error *e);
void language_runs_free(struct language_runs *runs);

#endif
