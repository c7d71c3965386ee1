/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits text into words as the index compares them: without case and accents, with i for the Turkish
 * dotless i. An apostrophe separates words (l'amor: l, amor). */
#ifndef FACCIA_LIBRARY_WORDS_H
#define FACCIA_LIBRARY_WORDS_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { WORD_BYTES_MAX = 64 }; /* longer words are cut */

struct word {
    size_t from, to;             /* byte offsets in the text */
    char lower[WORD_BYTES_MAX];  /* lower case, with accents: input of the stemmer */
    char folded[WORD_BYTES_MAX]; /* form used for comparison */
};

/* Finds the next word at or after *at, and moves *at past it. turkish: I is the capital of the dotless i.
 * False: none. */
bool words_next(const char *text, size_t size, bool turkish, size_t *at, struct word *word);

/* True for an Italian or English article or the like that an apostrophe joins to the next word. */
bool words_elided(const char *folded);

/* Old spellings by language ("huomo" is uomo), one file each. */

enum { STEM_LANGUAGES = 4 };

struct spellings;

/* folder: of LANG.json; NULL: none. Returns NULL with *e ("bad-normalization"). */
struct spellings *spellings_load(const char *folder, struct error *e);
void spellings_free(struct spellings *spellings);

/* Differs when the rules differ. */
uint64_t spellings_hash(const struct spellings *spellings);

/* Writes the word, in lower case, as it is spelled today. language: as for stems_language. False: the same.
 */
bool spellings_modern(const struct spellings *spellings, size_t language, const char *lower,
                      char out[WORD_BYTES_MAX]);

/* Stems of words, by libstemmer's Snowball stemmers (M. F. Porter, 2001). Not thread-safe. */

struct stems;

/* Marks stems in the index, a private-use letter (U+E000). Without it a stem that is also a word would
 * share that word's postings, and searches would read both. */
#define STEM_SIGN "\xEE\x80\x80"

/* spellings: borrowed; NULL: none. */
struct stems *stems_open(const struct spellings *spellings);
void stems_close(struct stems *stems);

/* Writes the folded stems that find a word of that language (BCP 47): its own, that of the word without
 * accents, and that of the word as it is spelled today, if they differ. 0: no stemmer for the language. */
enum { STEM_FORMS_MAX = 3 };
size_t stems_forms(struct stems *stems, const char *lang, const struct word *word,
                   char out[STEM_FORMS_MAX][WORD_BYTES_MAX]);

/* Languages with a stemmer, by number from 0; NULL: no more. */
const char *stems_language(size_t i);

#endif
