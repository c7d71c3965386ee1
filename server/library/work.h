/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A work of literature, whatever its file: sections of blocks. Readers make it section by section with
 * builder.h; what they cannot make sense of they tell. Texts are UTF-8; places are bytes. */
#ifndef FACCIA_LIBRARY_WORK_H
#define FACCIA_LIBRARY_WORK_H

#include "server/base/buf.h"
#include "server/base/error.h"
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

/* STAGE: a stage direction inside a speech, which is read and not spoken. */
enum mark_kind { MARK_EMPHASIS, MARK_FOREIGN, MARK_NAME, MARK_NOTE, MARK_PAGE, MARK_STAGE };

struct block_mark {
    enum mark_kind kind;
    size_t start, end;
    char *value; /* FOREIGN: the language; NOTE: its name; PAGE: its number; else NULL */
};

struct block_line {
    size_t start, end;
    char *n; /* as the edition has it; NULL: it is counted */
    bool indent;
};

struct block {
    enum block_kind kind;
    char name[16]; /* in its section: "p2"; "" where it has none */
    char *lang, *speaker, *n;
    struct buf text;
    char *source; /* MARKUP: what is spoken instead of the text */
    const char *markup;
    unsigned level; /* of a head, from 1 */
    bool item;
    unsigned first_line; /* of the section; from 1 */
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
    size_t characters; /* of what can be read */
    unsigned passages, lines, counts[BLOCK_PAGE + 1];
};

struct work_meta {
    char *title, *author, *lang, *date, *publisher, *licence, *source;
    const char *format;
};

struct work_sink {
    void *ctx;
    int (*section)(void *ctx, const struct section *section); /* not 0: no more is wanted */
    void (*problem)(void *ctx, const struct error *e, bool serious);
};

/* What a file may have. */
enum {
    WORK_FILE_BYTES_MAX = 64 << 20,     /* of a text, and of one file in an EPUB */
    WORK_ARCHIVE_BYTES_MAX = 256 << 20, /* of all that is read of an EPUB */
    WORK_ARCHIVE_FILES_MAX = 10000,
    WORK_DEPTH_MAX = 256,        /* of elements */
    SECTION_CHARACTERS = 100000, /* a longer one is continued in another */
    SECTIONS_MAX = 100000,
    WORK_BYTES_MAX =
        64 << 20,           /* of its text, blocks, lines and marks; the index takes about four times that */
    WORK_BYTES_FACTOR = 4,  /* times the file's size, if that is more */
    WORK_SECONDS_MAX = 120, /* of processor time, indexing included */
    BLOCK_BYTES_MAX = 1 << 20, /* a longer one is continued in another */
    NOTE_DEPTH_MAX = 4,
    PROBLEMS_MAX = 50, /* told of a file */
};

void work_meta_free(struct work_meta *meta);

/* Sets a text of the meta once: what came first stays. */
void work_meta_set(char **field, const char *text);

/* What is spoken of a block: its text with white space in place of stage directions, which has as many bytes
 * and as many UTF-16 units as they have, so that places stay. */
void block_spoken(const struct block *block, struct buf *out);

void block_free(struct block *block);
void section_free(struct section *section);

/* What is said of a link that is not followed. */
#define WORK_OUTSIDE                                                                                         \
    "a link that leads out of the library's folder is not followed (one within it is relative)"

/* Reads a file below a folder (open_below.h), of any kind that is known by its ending (and, .xml, by its root):
 * sections go to the sink.
 * Begins with meta zeroed but for lang, which is that of works that do not tell theirs. -1 with *e: it could
 * not be read, or not to its end; sections until then were given. */
int work_read(const char *folder, const char *path, struct work_meta *meta, const struct work_sink *sink,
              struct error *e);

/* Its two steps: opens the file, or NULL with *e; reads it, of the kind that its name says. */
FILE *work_open(const char *folder, const char *path, struct error *e);
int work_read_file(const char *name, FILE *file, struct work_meta *meta, const struct work_sink *sink,
                   struct error *e);

/* Can the content of a file of that name be read, all of it? Of any kind but EPUB. -1 with *e: "bad-field" of
 * the name, "bad-work" with the first thing that is wrong. */
int work_check(const char *name, const void *data, size_t size, struct error *e);

/* Is it a file of such an ending? */
bool work_is(const char *path);

#endif
