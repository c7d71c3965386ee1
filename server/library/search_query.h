/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What people write into a search box, as a query of FTS5, and what of a text it means. */
#ifndef FACCIA_LIBRARY_SEARCH_QUERY_H
#define FACCIA_LIBRARY_SEARCH_QUERY_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/library/stems.h"

enum { QUERY_BYTES_MAX = 1000, QUERY_TERMS_MAX = 32, QUERY_STEMS_MAX = 9, QUERY_DEPTH_MAX = 16 };

struct query_term {
    char word[WORD_BYTES_MAX];
    char stems[QUERY_STEMS_MAX][WORD_BYTES_MAX]; /* the word itself, which may be one, and those of the
                                                    languages that are searched; each once */
    size_t stem_count;                           /* 0: what is written so, or begins so */
    bool prefix;
};

struct search_query {
    struct buf match; /* for FTS5; terminated */
    struct query_term terms[QUERY_TERMS_MAX];
    size_t count;
};

struct query_options {
    struct stems *stems;
    const char *langs; /* whose stems are looked for, parted by commas; NULL = all */
};

/* -1 with *e: "bad-query" at a byte of the text. Free it all the same. */
int search_query_read(struct search_query *query, const char *text, const struct query_options *options,
                      struct error *e);
void search_query_free(struct search_query *query);

/* Is the word of a text written as the term is? */
bool search_term_written(const struct query_term *term, const struct word *word);

/* Does a word of a text in that language answer one of the terms? */
bool search_query_means(const struct search_query *query, struct stems *stems, const char *lang,
                        const struct word *word);

/* Is the tag, or the language of the tag, in the list? NULL: all are. */
bool search_list_has(const char *list, const char *tag, bool language);

#endif
