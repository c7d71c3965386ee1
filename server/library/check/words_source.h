/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of a work's source, for words_check.c. */
#ifndef FACCIA_LIBRARY_CHECK_WORDS_SOURCE_H
#define FACCIA_LIBRARY_CHECK_WORDS_SOURCE_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { CHECKED_WORD_MAX = 200, CHECKED_NESTED_MAX = 16 };

/* Every distinct word has a number. */
struct vocabulary {
    char **words;
    size_t count, cap;
    uint32_t *slots; /* number + 1; 0: empty */
    size_t slot_count;
};

/* Number of a word, which is added if it is new. words_check.c */
uint32_t vocabulary_number(struct vocabulary *v, const char *word, size_t size);

struct found_word {
    uint32_t number, line;
    uint16_t document; /* of an EPUB, from 1 */
    bool optional;     /* a note's sign: it may be read or not */
    bool missed;       /* lost, or read too often */
};

struct word_list {
    struct found_word *list;
    size_t count, cap;
};

/* Splits text into words: runs of letters, digits and combining marks. An inset (a note) interrupts a word
 * without ending it, so the word in progress is kept for each level. */
struct collector {
    struct vocabulary *vocabulary;
    struct word_list *words;
    struct {
        char bytes[CHECKED_WORD_MAX];
        size_t size;
    } open[CHECKED_NESTED_MAX];
    unsigned depth;
    uint32_t line, last, before; /* the last two characters */
    uint16_t document;
    bool optional;
    enum { JOIN_NO, JOIN_LOWER, JOIN_ALWAYS } join; /* whether the next letter continues the last word */
};

void collector_add(struct collector *c, const char *text, size_t size);
void collector_character(struct collector *c, uint32_t cp);
void collector_end_word(struct collector *c);

/* The end of a line, column or page of an edition. join: it divides a word. */
void collector_break(struct collector *c, bool join);

/* Adds text with its character references replaced. words_source.c */
void collector_references(struct collector *c, const char *text, size_t size);

/* Adds the words of a Markdown text, whose first line is c->line. words_markdown.c */
void words_markdown_read(struct collector *c, const char *text, size_t size);

/* Beginning and end of an inset. */
void collector_inset(struct collector *c);
void collector_inset_end(struct collector *c);

/* Collects the words of a file: its name's ending tells the format. data: its content in UTF-8, with a NUL
 * after it; an EPUB is read from `file`. left_out: words in elements that are not read. -1: it cannot be
 * read. */
int words_source_read(struct collector *c, const char *path, FILE *file, const struct buf *data,
                      size_t *left_out);

#endif
