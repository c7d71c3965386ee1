/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stretches of a plain text that different persons speak, given by a request as a JSON array:
 * [{"id":"anna","name":"Anna","voice":"...","gender":"female","pitch":1.1,"rate":0.9,"affect":"joy",
 *   "at":"0-12 30-44"}], with positions in UTF-16 units. */
#ifndef FACCIA_MARKUP_SPEAKER_RUNS_H
#define FACCIA_MARKUP_SPEAKER_RUNS_H

#include "server/base/error.h"
#include <stddef.h>

enum { SPEAKERS_MAX = 1000 };

struct speaker {
    char *id, *name;               /* id "": the narrator */
    char *voice, *gender, *affect; /* NULL: the request's */
    double pitch, rate;            /* factors */
};

struct speaker_run {
    size_t from, to; /* bytes of the text */
    size_t speaker;
};

/* Ascending, without overlaps. Zeroed: empty. */
struct speaker_runs {
    struct speaker *speakers;
    size_t speaker_count;
    struct speaker_run *list;
    size_t count, cap;
};

/* Parses `written` for text[0..size), which is well-formed UTF-8. Bytes beyond the end of the text are
 * ignored. Returns -1 with *e: "bad-field" in "speakers". */
int speaker_runs_read(struct speaker_runs *runs, const char *written, const char *text, size_t size,
                      struct error *e);
void speaker_runs_free(struct speaker_runs *runs);

/* Who speaks the byte; NULL: nobody in particular. *edge (may be NULL): where that changes next; SIZE_MAX:
 * nowhere. runs may be NULL. */
const struct speaker *speaker_runs_at(const struct speaker_runs *runs, size_t byte, size_t *edge);

#endif
