/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of works: a background thread keeps its index up to date, and any thread may query it. */
#ifndef FACCIA_LIBRARY_LIBRARY_H
#define FACCIA_LIBRARY_LIBRARY_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/work/reader_process.h"
#include "server/library/cast.h"
#include "server/library/recordings/alignments.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct library;

struct library_options {
    const char *folder;    /* folder of the works */
    const char *index;     /* path of the index */
    const char *voices;    /* folder described in library_voices.h; NULL: recordings are not used as voices */
    const char *lang;      /* default language of a work */
    const char *spellings; /* folder of old spellings, see words.h; NULL: none */
    const char *directions; /* folder of moods of stage directions, see words.h; NULL: none */
    struct aligner aligner; /* aligns recordings */
    struct reader reader;   /* reads works */
};

/* Opens the index and starts to scan the folder. NULL with *e: "bad-index", "bad-work". */
struct library *library_open(const struct library_options *options, struct error *e);

/* Scans the folder now rather than at the next interval. */
void library_look(struct library *library);

/* Waits for the library's thread to stop, at most for the time of reading one block. */
void library_close(struct library *library);

/* A query; NULL members are absent. */
struct library_question {
    enum {
        LIBRARY_LIST,
        LIBRARY_WORK,    /* needs work */
        LIBRARY_CAST,    /* needs work, offer */
        LIBRARY_SECTION, /* needs work, section */
        LIBRARY_PASSAGE, /* needs passage */
        LIBRARY_SEARCH,
        LIBRARY_CONCORDANCE,
        LIBRARY_NEWEST, /* needs most */
    } kind;
    const char *work, *section, *passage;
    const char *query, *lang, *author, *limit, *after;
    const char *form, *century, *kinds; /* of a search: lists separated by commas */
    const char *prefer;                 /* languages whose places come first */
    bool facets;                        /* counts by author, language and so on, too */
    const char *width;                  /* of a concordance: characters on each side */
    const char *directions;             /* of a passage, as in a request: "spoken" */
    bool names;                         /* of a passage: of those who speak, too */
    unsigned most;                      /* number of works */
    const struct cast_offer *offer;
    const atomic_bool *given_up; /* becomes true when the client is gone; NULL: never */
};

/* The cast of the work of a passage ("WORK", "WORK:SECTION..."), chosen anew each time from the index, the
 * file beside the work and the offer. Callable from any thread. -1 with *e. Free it with cast_free. */
int library_cast(struct library *library, const char *passage, const struct cast_offer *offer,
                 struct cast *cast, struct error *e);

/* Writes the answer as JSON; callable from any thread. -1 with *e: "unknown-work", "unknown-section",
 * "unknown-passage", "bad-query", "bad-field", "search-too-long" (or given up), "bad-index". */
int library_answer(struct library *library, const struct library_question *question, struct buf *answer,
                   struct error *e);

/* Progress of prerendering (publish/prerender.h), in sections and bytes of sound. */
struct library_prerender {
    char voice[80];
    enum library_prerender_state {
        PRERENDER_NONE,
        PRERENDER_WAITING, /* for the voice or the index */
        PRERENDER_SPEAKING,
        PRERENDER_RESTING, /* other speech is using the voice */
        PRERENDER_DONE,
        PRERENDER_FULL, /* the cache limit is reached */
    } state;
    unsigned done, of;
    uint64_t bytes, most;
};
void library_set_prerender(struct library *library, const struct library_prerender *prerender);

/* Changes whenever the works change; 0 during the first scan. */
uint64_t library_version(struct library *library);

struct library_place {
    char work[80];
    unsigned sections;
};
/* Finds the next work, by id, in a language ("it") or one of its varieties. 1: found; 0: none; -1 with *e.
 * library_sections counts the sections of all such works. */
int library_next_work(struct library *library, const char *lang, const char *after, struct library_place *out,
                      struct error *e);
void library_sections(struct library *library, const char *lang, unsigned *out);

/* Appends metrics in Prometheus' text format. */
void library_metrics(struct library *library, struct buf *out);

/* The spoken form of a passage. Free it with library_passage_free. */
struct library_passage {
    char *text, *lang;
    struct cast_speech *speeches; /* who speaks, ascending; the narrator speaks the rest */
    size_t speech_count;
    char *languages;    /* stretches in other languages, in the syntax of a request; NULL: none */
    char *voice;        /* the voice of its recording; NULL: none */
    const char *markup; /* "plain" or the markup of the text; static */
};

/* from: UTF-16 units to replace by spaces at the beginning. most: bytes after which a text may end early.
 * -1 with *e: "unknown-passage", "bad-field". Reads the index in the calling thread; the time depends on
 * the passage, not on its section. */
struct library_reading {
    double from;
    size_t most;
    bool directions; /* stage directions are spoken; those of a section that stand alone, too */
    bool names;      /* of a section: the names of those who speak, too */
    bool dialogue;   /* who speaks in the dialogue of prose, too */
};
int library_passage(struct library *library, const char *id, const struct library_reading *how,
                    struct library_passage *out, struct error *e);
void library_passage_free(struct library_passage *passage);

#endif
