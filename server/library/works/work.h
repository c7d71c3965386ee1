/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A work of literature in a common form: sections of blocks. Readers build it section by section
 * (readers.h) and report what they cannot interpret. Text is UTF-8; positions are bytes. */
#ifndef FACCIA_LIBRARY_WORKS_WORK_H
#define FACCIA_LIBRARY_WORKS_WORK_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/work/reader_process.h"
#include <stdbool.h>
#include <stdio.h>

enum block_kind {
    BLOCK_HEAD,
    BLOCK_PARAGRAPH,
    BLOCK_VERSE,
    BLOCK_NOTE,
    BLOCK_SPEAKER,
    BLOCK_STAGE,
    BLOCK_PAGE,
};

/* STAGE: a stage direction within a speech, shown but not spoken. */
enum mark_kind { MARK_EMPHASIS, MARK_FOREIGN, MARK_NAME, MARK_NOTE, MARK_PAGE, MARK_STAGE };

struct block_mark {
    enum mark_kind kind;
    size_t start, end;
    char *value; /* FOREIGN: language; NOTE: name of the note; PAGE: number; otherwise NULL */
};

struct block_line {
    size_t start, end;
    char *n; /* the edition's number; NULL: count lines */
    bool indent;
    bool goes_on; /* it continues the verse of the line before it */
};

struct block {
    enum block_kind kind;
    char name[16]; /* within the section: "p2"; "" if it has none */
    char *lang, *speaker, *n;
    char *who; /* id of who speaks, as in the source (several joined by +); NULL: from the name */
    struct buf text;
    char *source; /* MARKUP: spoken instead of the text */
    const char *markup;
    unsigned level; /* of a heading, from 1 */
    bool item;
    unsigned first_line; /* number within the section, from 1 */
    struct block_mark *marks;
    size_t mark_count, mark_cap;
    struct block_line *lines;
    size_t line_count, line_cap;
};

struct section {
    unsigned number, level;
    char *title;
    struct block *blocks;
    size_t count, cap;
    size_t characters; /* characters of readable text */
    unsigned passages, lines, counts[BLOCK_PAGE + 1];
    unsigned continued; /* lines that continue another one's verse */
};

enum person_sex { SEX_UNKNOWN, SEX_FEMALE, SEX_MALE };

/* A person of a play or dialogue, as the source lists it. */
struct work_person {
    char *id;    /* "": listed without one */
    char *name;  /* "": the id is all that is known */
    char *about; /* description; NULL: none */
    enum person_sex sex;
    unsigned age; /* years; 0: unknown */
};

struct work_meta {
    char *title, *author, *lang, *date, *publisher, *licence, *source;
    const char *format;
    struct work_person *persons; /* in the order of the source */
    size_t person_count;
};

struct work_sink {
    void *ctx;
    int (*section)(void *ctx, const struct section *section); /* nonzero: stop reading */
    void (*problem)(void *ctx, const struct error *e, bool serious);
};

/* Limits of a file. */
enum {
    WORK_FILE_BYTES_MAX = 64 << 20,     /* of a text, and of one file in an EPUB */
    WORK_ARCHIVE_BYTES_MAX = 256 << 20, /* unpacked from an EPUB */
    WORK_ARCHIVE_FILES_MAX = 10000,
    WORK_DEPTH_MAX = 256,        /* of nested elements */
    SECTION_CHARACTERS = 100000, /* a longer one continues in another */
    SECTIONS_MAX = 100000,
    WORK_BYTES_MAX =
        64 << 20,           /* of text, blocks, lines and marks; the index takes about four times as much */
    WORK_BYTES_FACTOR = 4,  /* times the file's size, if that is more */
    WORK_SECONDS_MAX = 120, /* of processor time, including indexing */
    BLOCK_BYTES_MAX = 1 << 20, /* a longer one continues in another */
    NOTE_DEPTH_MAX = 4,
    PROBLEMS_MAX = 50, /* reported for a file */
    PERSONS_MAX = 2000,
};

void work_meta_free(struct work_meta *meta);
void work_persons_free(struct work_person *persons, size_t count);

/* Sets a metadata field unless it is set. */
void work_meta_set(char **field, const char *text);

/* Appends the spoken text of a block. Stage directions become white space of the same length in bytes and
 * UTF-16 units, so that offsets stay valid. */
void block_spoken(const struct block *block, struct buf *out);

void section_free(struct section *section);

/* Message for a link that is not followed. */
#define WORK_OUTSIDE                                                                                         \
    "a link that leads out of the library's folder is not followed (one within it is relative)"

/* Reads a file below a folder (files.h) and passes its sections to the sink. The ending, and for .xml
 * the root, decides the format. meta begins zeroed, with lang as the default language. -1 with *e: it
 * could not be read completely; earlier sections were delivered. */
int work_read(const char *folder, const char *path, struct work_meta *meta, const struct work_sink *sink,
              struct error *e);

/* words_check.c: words of a work as counted by a scanner that shares nothing with the readers. */
struct words_report {
    size_t source, read, left_out; /* left_out: in elements that are not read, such as deletions */
    size_t lost, doubled, glued, divided;
    void (*tell)(void *ctx, const char *what, size_t line, const char *word, const char *next);
    void *ctx; /* tell: called for the first occurrences of each kind; line 0: unknown */
};

/* Compares what work_read delivers with the file. The caller sets tell and ctx. -1 with *e. */
int words_check(const char *folder, const char *path, struct words_report *report, struct error *e);

/* Opens the file for work_read, or NULL with *e. */
FILE *work_file_open(const char *folder, const char *path, struct error *e);

/* True when the ending is that of a work. */
bool work_is(const char *path);

/* Reading in another process (base/work/reader_process.h): the result arrives as frames, which are validated
 * as strictly as the file itself. */

/* Like work_read and work_check, but in a separate process, or in this one without a reader program. Setting
 * *given_up (may be NULL) ends it with "bad-work". A work that exceeds the limits fails; the sections before
 * that were delivered, and *e names the last one. */
int work_read_apart(const struct reader *reader, const char *folder, const char *path, struct work_meta *meta,
                    const struct work_sink *sink, const atomic_bool *given_up, struct error *e);
int work_check_apart(const struct reader *reader, const char *name, const void *data, size_t size,
                     const atomic_bool *given_up, struct error *e);

/* The child's part: reads the file `in` and writes it as frames to `out`. -1: `out` is closed. */
int work_apart_read(const char *name, const char *lang, int in, int out);

/* The same for work_check, with the content of `in`. */
int work_apart_check(const char *name, int in, int out);

#endif
