/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The index: an SQLite database with the works as they are shown and the words that they are found by. What
 * its files share. One writes, many read (write-ahead logging); what was not committed when a process died is
 * not there. */
#ifndef FACCIA_LIBRARY_INDEX_INTERNAL_H
#define FACCIA_LIBRARY_INDEX_INTERNAL_H

#include "server/library/stems.h"
#include "server/library/work.h"
#include <sqlite3.h>
#include <stdint.h>

/* Rows of `passage`, whose numbers are those of `found`: a block, or a part of one that is long. */
enum { PART_LINES = 12, PART_BYTES = 4000 };

struct index_writer {
    sqlite3 *sql;
    struct stems *stems;
    sqlite3_stmt *statements[16];
    bool open;         /* a transaction is */
    size_t characters; /* in it */
    int64_t next;      /* row */
    bool damaged;      /* SQLite has found the file to be no index, or a broken one */
};

/* Is that error one of a damaged file? */
bool index_is_damaged(sqlite3 *sql);

/* Removes the file with what belongs to it, and says so in the log: it is begun anew when it is opened. */
void index_discard(const char *file);

/* Opens, and makes, it. A damaged one, or of another version, is begun anew. -1 with *e. */
int index_open(struct index_writer *writer, const char *file, struct error *e);
void index_close(struct index_writer *writer);
sqlite3 *index_open_reader(const char *file); /* NULL: it cannot be */

/* A statement, made once; its parameters are empty. */
sqlite3_stmt *index_statement(struct index_writer *writer, unsigned number, const char *sql);
int index_step(struct index_writer *writer, sqlite3_stmt *statement, struct error *e);
int index_begin(struct index_writer *writer, struct error *e);
int index_commit(struct index_writer *writer, struct error *e);
void index_roll_back(struct index_writer *writer);

/* What is known of a file. */
struct index_file {
    int64_t size, modified; /* bytes; ns */
    char hash[65];
    char work[80]; /* its name; "" = it could not be read */
};
bool index_file_get(struct index_writer *writer, const char *path, struct index_file *out);
int index_file_set(struct index_writer *writer, const char *path, const struct index_file *file,
                   struct error *e);

/* Takes the file's work and problems away. */
int index_remove(struct index_writer *writer, const char *path, struct error *e);

/* Adds a section to a work. */
int index_add_section(struct index_writer *writer, const char *work, const char *lang,
                      const struct section *section, struct error *e);

/* The work itself, when its sections are there. */
int index_add_work(struct index_writer *writer, const char *name, const char *path, const char *hash,
                   const struct work_meta *meta, int64_t first_row, bool recording, struct error *e);
int index_add_problem(struct index_writer *writer, const char *path, const struct error *problem,
                      bool serious, struct error *e);

/* index_text.c: the columns of `found` for a text. */
void index_columns(struct stems *stems, const char *lang, const char *text, size_t size, struct buf *words,
                   struct buf *stemmed);

/* index_shape.c: a block without its text, as JSON; to be freed. */
char *index_shape(const struct block *block);

#endif
