/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the library share. */
#ifndef FACCIA_LIBRARY_LIBRARY_INTERNAL_H
#define FACCIA_LIBRARY_LIBRARY_INTERNAL_H

#include "server/base/utf8.h"
#include "server/library/index_internal.h"
#include "server/library/library.h"
#include "server/library/library_files.h"
#include "server/library/recordings/alignments.h"
#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

enum { READERS_MAX = 8 };

/* A connection for one question at a time. */
struct index_reader {
    sqlite3 *sql;
    struct stems *stems;
    unsigned generation; /* of the index that it has open */
    bool damaged;        /* it met a damaged page: what it has read is not all */
};

/* How long an answer may take. SQLite asks now and then. */
struct answer_limit {
    const atomic_bool *given_up; /* or NULL */
    uint64_t until;              /* ms of the monotonic clock */
    bool late;                   /* it took longer, or nobody waits any more */
};

struct library {
    char *folder, *index, *voices, *lang;
    pthread_t thread;
    pthread_mutex_t mutex; /* over what follows */
    pthread_cond_t wake;
    struct index_reader *idle[READERS_MAX]; /* that nobody uses now */
    unsigned idle_count;
    unsigned generation; /* of the index; another one, when it was begun anew */
    size_t done, of;     /* files of this pass */
    bool indexing, closing;
    atomic_bool stop;
    atomic_bool damaged;  /* somebody who reads the index has found it so: the thread begins it anew */
    struct reader reader; /* its program is owned */
    struct alignments *alignments; /* NULL: recordings are no voices */
    uint64_t signature;            /* of the files that were looked through last; the thread sets it */
    struct library_ahead ahead;
};

/* library.c */
struct index_reader *library_reader(struct library *library, struct error *e);
void library_reader_done(struct library *library, struct index_reader *reader);

/* library_scan.c: the thread. */
void *library_scan(void *library);

/* library_recorded.c: hands what has a recording now to the alignments, and sets it right in the index. -1
 * with *e. */
int library_recorded(struct library *library, struct index_writer *writer, const struct library_files *files,
                     struct error *e);

/* library_answer.c, library_section.c, library_search.c, library_newest.c: an answer; NULL with *e. */
json_t *library_section_json(struct library *library, struct index_reader *reader, const char *work,
                             const char *section, struct error *e);
json_t *library_search_json(struct index_reader *reader, const struct library_question *question,
                            struct answer_limit *limit, struct error *e);
json_t *library_newest_json(struct index_reader *reader, unsigned most, struct error *e);
json_t *library_passage_json(struct index_reader *reader, const char *id, struct error *e);

/* library_ahead.c */
json_t *library_ahead_json(struct library *library); /* NULL: nothing is spoken ahead */

/* library_read.c */

/* Sets late when it is. */
bool answer_is_late(struct answer_limit *limit);

/* After statements: notes whether the file turned out to be damaged. */
void library_reader_look(struct index_reader *reader);

/* A statement, to be finalised; NULL with *e. */
sqlite3_stmt *library_prepare(struct index_reader *reader, const char *sql, struct error *e);
json_t *library_text(sqlite3_stmt *statement, int column); /* a string, or null */

/* library_section.c: a passage's place and text. */
struct found_run {
    size_t start, end; /* UTF-16 units of the text */
    char lang[36];     /* "": a stage direction, which is not spoken */
};
struct found_passage {
    char work[80], name[24]; /* name "": a section */
    unsigned section;
    char kind[16], block[16]; /* "line" of a verse block */
    char lang[36], markup[8];
    struct buf text, source; /* source: what is spoken, when it is not the text */
    struct found_run *runs;  /* of the text, in another language or not spoken; they may nest */
    size_t run_count, run_cap;
    struct utf16_counter units; /* of the text so far */
    char n[32];
};
/* Of a text longer than `most` bytes no more than its beginning, a little longer than that. */
int library_find(struct index_reader *reader, const char *id, size_t most, struct found_passage *out,
                 struct error *e);
void found_passage_free(struct found_passage *passage);

/* A whole number from min to max; otherwise when there is none. -1 with *e. */
int library_number(const char *field, const char *text, unsigned min, unsigned max, unsigned otherwise,
                   unsigned *out, struct error *e);

#endif
