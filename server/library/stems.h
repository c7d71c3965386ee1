/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stems of words, by the Snowball stemmers (M. F. Porter, 2001) of libstemmer. One thread at a time. */
#ifndef FACCIA_LIBRARY_STEMS_H
#define FACCIA_LIBRARY_STEMS_H

#include "server/library/words.h"

struct stems;

/* Stands before a stem in the index, a letter of private use (U+E000): a stem that is a word, too, would have
 * its places among the word's, and be sought through all of them. */
#define STEM_SIGN "\xEE\x80\x80"

struct stems *stems_open(void);
void stems_close(struct stems *stems);

/* The stems that a word of that language (BCP 47) is found by, folded: its own, and where its accents make
 * another of it, that of the word without them. 0: the language has none. */
enum { STEM_FORMS_MAX = 2 };
size_t stems_forms(struct stems *stems, const char *lang, const struct word *word,
                   char out[STEM_FORMS_MAX][WORD_BYTES_MAX]);

/* The languages that have stems, by number from 0; NULL: no more. */
const char *stems_language(size_t i);

#endif
