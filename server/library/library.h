/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of works: its index, which a thread of its own keeps up to date, and what is asked of it. */
#ifndef FACCIA_LIBRARY_LIBRARY_H
#define FACCIA_LIBRARY_LIBRARY_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/reader_process.h"
#include "server/library/recordings/alignment_job.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct library;

struct library_options {
    const char *folder;     /* of works */
    const char *index;      /* the file of the index */
    const char *voices;     /* the folder of library_voices.h; NULL: nothing has a recording's voice */
    const char *lang;       /* of works that do not tell theirs */
    struct aligner aligner; /* of recordings */
    struct reader reader;   /* of works */
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
    unsigned most;               /* works */
    const atomic_bool *given_up; /* turns true when nobody waits for the answer any more; NULL: never */
};

/* The answer as JSON, in any thread. -1 with *e: "unknown-work", "unknown-section", "unknown-passage",
 * "bad-query", "bad-field", "search-too-long" (or given up), "bad-index". */
int library_answer(struct library *library, const struct library_question *question, struct buf *answer,
                   struct error *e);

/* How far the works are spoken ahead (publish/speak_ahead.h): sections, bytes of sound. */
struct library_ahead {
    char voice[80];
    enum library_ahead_state {
        LIBRARY_AHEAD_NONE,
        LIBRARY_AHEAD_WAITING, /* for the voice, or the index */
        LIBRARY_AHEAD_SPEAKING,
        LIBRARY_AHEAD_RESTING, /* as somebody wants to hear the voice */
        LIBRARY_AHEAD_DONE,
        LIBRARY_AHEAD_FULL, /* no more is to be kept */
    } state;
    unsigned done, of;
    uint64_t bytes, most;
};
void library_set_ahead(struct library *library, const struct library_ahead *ahead);

/* Another number, when the works are others; 0 while they are read for the first time. */
uint64_t library_version(struct library *library);

struct library_place {
    char work[80];
    unsigned sections;
};
/* The next work in that language (its first part: "it") or a variety of it, by id. 1, 0 when there is none,
 * -1 with *e; and how many sections all of these have. */
int library_next_work(struct library *library, const char *lang, const char *after, struct library_place *out,
                      struct error *e);
void library_sections(struct library *library, const char *lang, unsigned *out);

/* What it counts, in Prometheus' text format. */
void library_metrics(struct library *library, struct buf *out);

/* What is spoken of a passage. Free the texts. */
struct library_passage {
    char *text, *lang;
    char *languages;    /* the stretches in others, as a request has them; NULL = none */
    char *voice;        /* of its recording; NULL = it has none */
    const char *markup; /* "plain", or the markup that the text is in; static */
};

/* from: UTF-16 units of the text that are left out, as spaces; most: a text of more bytes may end behind
 * them, but does not end before. -1 with *e: "unknown-passage", "bad-field". Takes a few reads of the index,
 * in the caller's thread; as many as the text has, not its section. */
int library_passage(struct library *library, const char *id, double from, size_t most,
                    struct library_passage *out, struct error *e);
void library_passage_free(struct library_passage *passage);

#endif
