/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of works: its index, which a thread of its own keeps up to date, and what is asked of it. */
#ifndef FACCIA_LIBRARY_LIBRARY_H
#define FACCIA_LIBRARY_LIBRARY_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>

struct library;

struct library_options {
    const char *folder; /* of works */
    const char *index;  /* the file of the index */
    const char *voices; /* the folder of library_voices.h; NULL: nothing has a recording's voice */
    const char *lang;   /* of works that do not tell theirs */
};

/* Opens the index and begins to read the folder. NULL with *e: "bad-index", "bad-work". */
struct library *library_open(const struct library_options *options, struct error *e);

/* Returns when its thread has ended: within the time that one block takes. */
void library_close(struct library *library);

/* What is asked: NULL where it was not said. */
struct library_question {
    enum {
        LIBRARY_LIST,
        LIBRARY_WORK,    /* work */
        LIBRARY_SECTION, /* work, section */
        LIBRARY_PASSAGE, /* passage */
        LIBRARY_SEARCH,
        LIBRARY_NEWEST, /* most */
    } kind;
    const char *work, *section, *passage;
    const char *query, *lang, *author, *limit, *after;
    unsigned most; /* works */
};

/* The answer as JSON, in any thread. -1 with *e: "unknown-work", "unknown-section", "unknown-passage",
 * "bad-query", "bad-field", "search-too-long", "bad-index". */
int library_answer(struct library *library, const struct library_question *question, struct buf *answer,
                   struct error *e);

/* What is spoken of a passage. Free the texts. */
struct library_passage {
    char *text, *lang;
    char *voice;        /* of its recording; NULL = it has none */
    const char *markup; /* "plain", or the markup that the text is in; static */
};

/* from: UTF-16 units of the text that are left out, as spaces. -1 with *e: "unknown-passage", "bad-field".
 * Takes a few reads of the index, in the caller's thread. */
int library_passage(struct library *library, const char *id, double from, struct library_passage *out,
                    struct error *e);
void library_passage_free(struct library_passage *passage);

#endif
