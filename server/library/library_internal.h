/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The index, the search and the queries of the library. The index is an SQLite database that holds the works
 * as they are displayed, and a full-text index of their words. One thread writes, many read (write-ahead
 * logging); uncommitted changes are lost when the process dies. */
#ifndef FACCIA_LIBRARY_LIBRARY_INTERNAL_H
#define FACCIA_LIBRARY_LIBRARY_INTERNAL_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/utf8.h"
#include "server/library/library.h"
#include "server/library/library_files.h"
#include "server/library/recordings/alignments.h"
#include "server/library/words.h"
#include "server/library/works/work.h"
#include <jansson.h>
#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdint.h>

/* Rules by which an index is made; both may be NULL. */
struct index_rules {
    struct spellings *spellings;
    struct directions *directions;
};

/* A block, or a part of a long block, is one row of `passage`, with the same row id in `found`. */
enum { PART_LINES = 12, PART_BYTES = 4000 };

struct index_writer {
    sqlite3 *sql;
    struct stems *stems;
    const struct index_rules *rules; /* borrowed */
    sqlite3_stmt *statements[20];
    bool open;         /* a transaction is open */
    size_t characters; /* written in the open transaction */
    int64_t next;      /* next row id */
    bool damaged;      /* SQLite reported that the file is corrupt or no database */
};

/* True when SQLite's last error means a damaged file. */
bool index_is_damaged(sqlite3 *sql);

/* Deletes the file and its WAL, with a warning in the log. The next index_open creates it anew. */
void index_discard(const char *file);

/* Opens or creates the index. Recreates a damaged file, or one of another version or made by other rules. -1
 * with *e. */
int index_open(struct index_writer *writer, const char *file, const struct index_rules *rules,
               struct error *e);
void index_close(struct index_writer *writer);
int64_t index_changes(struct index_writer *writer); /* transactions committed; -1: SQLite reports an error */
sqlite3 *index_open_reader(const char *file);       /* NULL: it cannot be opened */

int index_step(struct index_writer *writer, sqlite3_stmt *statement, struct error *e);
int index_begin(struct index_writer *writer, struct error *e);
int index_commit(struct index_writer *writer, struct error *e);
void index_roll_back(struct index_writer *writer);

/* Merges the parts of the full-text index, as a search reads all of them. Not within a transaction. */
void index_merge(struct index_writer *writer, const atomic_bool *stop);

/* A text column; "" for NULL. Valid until the statement is stepped or reset. */
const char *index_text(sqlite3_stmt *statement, int column);

/* A file as recorded in the index. */
struct index_file {
    int64_t size, modified; /* bytes; ns since the epoch */
    char hash[65];
    char work[80]; /* id; "" = the file could not be read */
};
bool index_file_get(struct index_writer *writer, const char *path, struct index_file *out);
int index_file_set(struct index_writer *writer, const char *path, const struct index_file *file,
                   struct error *e);

/* Removes the file's work and its problems. */
int index_remove(struct index_writer *writer, const char *path, struct error *e);

/* Adds a section to a work. */
int index_add_section(struct index_writer *writer, const char *work, const char *lang,
                      const struct section *section, struct error *e);

/* Adds the work itself, after its sections. */
int index_add_work(struct index_writer *writer, const char *name, const char *path, const char *hash,
                   const struct work_meta *meta, int64_t first_row, bool recording, struct error *e);
/* Keeps the id of a file's work, whose file is gone, for library_current. */
int index_add_former(struct index_writer *writer, const char *path, struct error *e);
/* Adds who speaks in a work. */
int index_add_cast(struct index_writer *writer, const char *work, const struct cast *cast, struct error *e);
int index_add_problem(struct index_writer *writer, const char *path, const struct error *problem,
                      bool serious, struct error *e);

/* Describes a block without its text, as JSON. Free it. */
char *index_shape(const struct block *block);

/* Parses what people type into a search box into an FTS5 query, and matches words of a text against it. */

enum { QUERY_BYTES_MAX = 1000, QUERY_TERMS_MAX = 32, QUERY_STEMS_MAX = 13, QUERY_DEPTH_MAX = 16 };

struct query_term {
    char word[WORD_BYTES_MAX];
    char stems[QUERY_STEMS_MAX][WORD_BYTES_MAX]; /* the word itself, which may be a stem, and its stems in the
                                                    searched languages; without duplicates */
    size_t stem_count;                           /* 0: matches the written form, or a prefix of it */
    bool prefix;
};

struct search_query {
    struct buf match; /* FTS5 query; NUL-terminated */
    struct query_term terms[QUERY_TERMS_MAX];
    size_t count;
    bool bare; /* words of which each must occur in some form, and nothing else */
};

struct query_options {
    struct stems *stems;
    const char *langs; /* languages to stem for, separated by commas; NULL: all */
    const char *only;  /* the one column to search, "speaker" or "stage"; NULL: the texts */
};

/* -1 with *e: "bad-query" with the byte. Free the query in either case. */
int search_query_read(struct search_query *query, const char *text, const struct query_options *options,
                      struct error *e);
void search_query_free(struct search_query *query);

/* True when a word of a text has the written form of the term. */
bool search_term_written(const struct query_term *term, const struct word *word);

/* True when a word of a text in that language matches one of the terms. */
bool search_query_means(const struct search_query *query, struct stems *stems, const char *lang,
                        const struct word *word);

/* True when the text, in that language, has a match for each term. */
bool search_query_has_all(const struct search_query *query, struct stems *stems, const char *lang,
                          const char *text);

/* True when the list contains the tag, or with `language` the tag's language. A NULL list contains
 * everything. */
bool search_list_has(const char *list, const char *tag, bool language);

/* ---- the library ---- */

enum { READERS_MAX = 8 };

/* A database connection, used for one query at a time. */
struct index_reader {
    sqlite3 *sql;
    struct stems *stems;
    unsigned generation;        /* of the index file that it has open */
    bool damaged;               /* it met a damaged page, so what it has read is incomplete */
    struct common_rows *common; /* counted reference while it is used; NULL: none */
};

/* Time limit of an answer, checked by SQLite's progress handler. */
struct answer_limit {
    const atomic_bool *given_up; /* may be NULL */
    uint64_t until;              /* ms of the monotonic clock */
    bool late;                   /* the limit has passed or the client has gone */
};

struct library {
    char *folder, *index, *voices, *lang;
    pthread_t thread;
    pthread_mutex_t mutex; /* protects what follows */
    pthread_cond_t wake;
    struct index_reader *idle[READERS_MAX]; /* unused connections */
    unsigned idle_count;
    unsigned generation; /* of the index; changes when the file is recreated */
    size_t done, of;     /* files of this scan */
    bool indexing, closing;
    bool look;                      /* somebody changed a file: scan now */
    struct work_lexicons *lexicons; /* work_lexicons.c */
    atomic_bool stop;
    atomic_bool damaged;           /* a reader found the index damaged: the scan recreates it */
    struct index_rules rules;      /* owned */
    struct reader reader;          /* program is owned */
    struct alignments *alignments; /* NULL: recordings are not used as voices */
    uint64_t signature;            /* hash of the files of the last scan; set by the scanning thread */
    struct common_rows *common;    /* counted reference */
    struct library_prerender prerender;
};

/* library.c */
struct index_reader *library_reader(struct library *library, struct error *e);
void library_reader_done(struct library *library, struct index_reader *reader);

/* search_query.c: adds the SQL function worth(found, MATCH), where MATCH is the statement's query: a larger
 * value is a better match. -1: SQLite refuses. */
int search_rank_add(sqlite3 *sql);

/* library_scan.c: the scanning thread. */
void *library_scan(void *library);

/* ---- search_common.c: rows of common words. Reference-counted and constant, so any thread may read them.
 * ---- */

struct common_rows;

/* Adds the SQL function that this uses; nonzero if that fails. */
int common_rows_add(sqlite3 *sql);

/* Reads the rows of the common stems, for an index without an open transaction. Returns NULL if SQLite
 * reports an error or *stop is set. */
struct common_rows *common_rows_make(struct index_writer *writer, const atomic_bool *stop);
struct common_rows *common_rows_keep(struct common_rows *rows); /* rows may be NULL */
void common_rows_release(struct common_rows *rows);

/* True if they are those of the index after that many changes. rows may be NULL. */
bool common_rows_are_of(const struct common_rows *rows, int64_t changes);

/* Returns the rows that match, as a set of *count * 64 bits. NULL: the query must be searched. Free it. */
uint64_t *common_rows_find(const struct common_rows *rows, struct index_reader *reader,
                           const struct search_query *query, size_t *count);

/* ---- search_places.c: the rows that match a query ---- */

/* A work as searches know it. */
struct shelf_work {
    char *name, *title, *author, *lang; /* "": not known */
    char *form;                         /* "drama", "verse" or "prose" */
    int century;                        /* 0: not known; negative: before the common era */
    bool mixed;                         /* has passages in other languages */
    bool chosen;                        /* the question selects it */
    int64_t first, last;                /* rows */
    size_t places;                      /* matching rows */
};

/* All works, by their rows. Zero-initialised. */
struct shelf {
    struct shelf_work *works;
    size_t count, cap;
};

int shelf_read(struct shelf *shelf, struct index_reader *reader, const struct library_question *question,
               struct error *e);
void shelf_free(struct shelf *shelf);

struct search_place {
    int64_t row;
    double worth;  /* of a ranked place */
    unsigned work; /* index in the shelf */
    bool ranked;
    bool preferred; /* its work is in a preferred language */
};

/* Adds the SQL function of search_places_find. Nonzero: SQLite refuses. */
int search_listing_add(sqlite3 *sql);

/* Kinds of results, by block_kind; a line of verse is found by its own. */
extern const char *const search_kinds[];

/* Zero-initialised. */
struct search_places {
    struct search_place *list; /* in the order of the library until search_places_rank */
    size_t count, cap, ranked;
    size_t total; /* counted rows */
    bool counted; /* all were: no row is missing */
};

/* Finds the rows in the works, languages and kinds that the question selects, in the library's order, and
 * fills the shelf. Returns -1 with *e ("bad-index"); an interruption by the progress handler is not an error.
 * Free both in either case. */
int search_places_find(struct search_places *places, struct shelf *shelf, struct index_reader *reader,
                       const struct search_query *query, const struct library_question *question,
                       struct error *e);

/* Puts ranked places first, the best of them first. Returns -1 with *e. */
int search_places_rank(struct search_places *places, const struct shelf *shelf, struct index_reader *reader,
                       const struct search_query *query, const struct library_question *question,
                       struct error *e);
void search_places_free(struct search_places *places);

/* How many places have each author, language, form, century and work; at most 50 values each. */
json_t *search_facets(const struct shelf *shelf);

/* Chosen works whose title or author has all words of the query. */
json_t *search_titles(const struct shelf *shelf, const struct search_query *query, struct stems *stems);

json_t *library_search_json(struct index_reader *reader, const struct library_question *question,
                            struct answer_limit *limit, struct error *e);

/* concordance.c: each occurrence with the text around it. */
json_t *library_concordance_json(struct index_reader *reader, const struct library_question *question,
                                 struct answer_limit *limit, struct error *e);

/* search.c: reads the question's query. -1 with *e. Free the query in either case. */
int search_question_read(struct search_query *query, struct index_reader *reader,
                         const struct library_question *question, struct error *e);

/* library_passage.c */
json_t *library_section_json(struct library *library, struct index_reader *reader, const char *work,
                             const char *section, struct error *e);
json_t *library_passage_json(struct index_reader *reader, const struct library_question *question,
                             struct error *e);

json_t *library_prerender_json(struct library *library); /* NULL: prerendering is off */

/* A limit that expires `ms` milliseconds from now. */
struct answer_limit answer_limit_in(unsigned ms, const atomic_bool *given_up);

/* True when the limit has passed; sets late. */
bool answer_is_late(struct answer_limit *limit);

/* library_cast.c: library_cast with a connection. */
int library_cast_of(struct library *library, struct index_reader *reader, const char *work,
                    const struct cast_offer *offer, struct cast *cast, struct error *e);

/* Call after statements: notes whether SQLite found the file damaged. */
void library_reader_look(struct index_reader *reader);

/* Prepares a statement; the caller finalises it. NULL with *e. */
sqlite3_stmt *library_prepare(struct index_reader *reader, const char *sql, struct error *e);
/* Returns the current id of a work, or of a place in it ("WORK:1:p2"): a file that was renamed or moved, and
 * has the same bytes, is found by its former id. Free it. */
char *library_current(struct index_reader *reader, const char *place);
json_t *library_text(sqlite3_stmt *statement, int column); /* a string, or null */

/* Parses a whole number from min to max; `otherwise` if text is NULL. -1 with *e. */
int library_number(const char *field, const char *text, unsigned min, unsigned max, unsigned otherwise,
                   unsigned *out, struct error *e);

#endif
