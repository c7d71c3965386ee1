/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of a search: what is compared of them. */
#ifndef FACCIA_LIBRARY_SEARCH_TERMS_H
#define FACCIA_LIBRARY_SEARCH_TERMS_H

#include "server/library/search_query.h"

/* Adds the stems that the word has in the languages that are searched. */
void search_term_stems(const struct query_options *options, struct query_term *term, const struct word *word);

/* The words of the text from `from` to `to`, at most so many: elided ones before an apostrophe fall away
 * unless all are wanted. */
size_t search_words(const char *text, size_t from, size_t to, bool all, struct word *words, size_t most);

#endif
