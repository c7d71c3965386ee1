/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What readers of files make a work with: blocks one after the other, which become sections. */
#ifndef FACCIA_LIBRARY_BUILDER_H
#define FACCIA_LIBRARY_BUILDER_H

#include "server/library/work.h"
#include <time.h>

struct builder {
    const struct work_sink *sink;
    struct section section;
    struct block *open[NOTE_DEPTH_MAX]; /* the block and the notes in it, outermost first */
    unsigned depth;
    struct block *pending; /* notes that stand behind the block */
    size_t pending_count, pending_cap;
    char *speaker;
    const char *lang;          /* of what comes now; the reader's */
    unsigned sections, told;   /* so far */
    bool space, stopped, keep; /* white space waits; keep: it counts as it is */
    enum { BREAK_NONE, BREAK_JOINS, BREAK_HYPHEN, BREAK_APART } line_break; /* before what comes next */
    bool soft;                                                              /* a soft hyphen came last */
    bool cut;              /* the reader was told that the block is too long */
    uint64_t bytes;        /* so far, of bytes_max */
    uint64_t bytes_max;    /* WORK_BYTES_MAX, unless builder_allow has raised it */
    struct timespec begun; /* processor time of the thread */
    struct error why;      /* stopped: the reason, where it is the work's */
    void (*where)(void *ctx, size_t *line, size_t *column); /* the place in the file; NULL: not known */
    void *where_ctx;
};

/* lang may be set anew at any time. */
void builder_open(struct builder *b, const struct work_sink *sink);

/* A file of so many bytes may take as many times its size: it is not small, and what it makes is its own. */
void builder_allow(struct builder *b, uint64_t file_bytes);

/* Gives what is left. Not 0: the sink has stopped it. */
int builder_close(struct builder *b);

/* Why it was stopped: a bound of the work (ERROR_BAD_WORK, at its place), or the sink. -1. */
int builder_why(const struct builder *b, struct error *e);

/* A new section, of that level from 1; its title is its first head. */
void build_section(struct builder *b, unsigned level);

/* A block; one that is open ends before it. */
void build_block(struct builder *b, enum block_kind kind);
void build_end(struct builder *b);
bool build_is_open(const struct builder *b);
enum block_kind build_kind(const struct builder *b); /* of the innermost open one */
struct block *build_top(struct builder *b);          /* the same, or NULL */

/* White space is one space, and none at the ends of blocks and lines. Soft hyphens and characters of no width
 * are left out. */
void build_text(struct builder *b, const char *text, size_t size);
void build_newline(struct builder *b);

/* The end of a line, column or page of the edition. join: it is inside a word, whose parts are one, without
 * the hyphen. Else it is white space; but a word that is hyphenated there is one, when it goes on with a
 * small letter. */
void build_break(struct builder *b, bool join);

/* What comes next is another word: white space goes between two letters or figures. */
void build_apart(struct builder *b);

/* Takes away what the innermost block has from that byte on. */
void build_cut(struct builder *b, size_t size);

/* A stretch of the text: begins, and ends, at what has been written. Nests. */
void build_mark(struct builder *b, enum mark_kind kind, const char *value);
void build_mark_end(struct builder *b, enum mark_kind kind);

/* A line of verses. n may be NULL. */
void build_line(struct builder *b, const char *n, bool indent);
void build_line_end(struct builder *b);

/* A note or a stage direction inside a block, or by itself. */
void build_inset(struct builder *b, enum block_kind kind, const char *n);
void build_inset_end(struct builder *b);

void build_page(struct builder *b, const char *n);
void build_speaker(struct builder *b, const char *name); /* NULL: nobody any more */

/* To the sink; the first PROBLEMS_MAX count. */
void build_problem(struct builder *b, const struct error *e, bool serious);

#endif
