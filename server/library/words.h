/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of a text as the index has them: without case and accents, i for the Turkish dotless one; what
 * stands between apostrophes is a word by itself (l'amor: l, amor). */
#ifndef FACCIA_LIBRARY_WORDS_H
#define FACCIA_LIBRARY_WORDS_H

#include <stdbool.h>
#include <stddef.h>

enum { WORD_BYTES_MAX = 64 }; /* a longer word is cut */

struct word {
    size_t from, to;             /* bytes of the text */
    char lower[WORD_BYTES_MAX];  /* in small letters, with its accents: what stems are made of */
    char folded[WORD_BYTES_MAX]; /* as it is compared */
};

/* The first word from *at on, which is moved behind it. turkish: I is the capital of the dotless one. False:
 * there is no more. */
bool words_next(const char *text, size_t size, bool turkish, size_t *at, struct word *word);

/* Takes the accents off a word that is in small letters. */
void words_fold(const char *lower, char out[WORD_BYTES_MAX]);

/* Is it an article or the like that an apostrophe joins to the next word, in Italian or English? */
bool words_elided(const char *folded);

#endif
