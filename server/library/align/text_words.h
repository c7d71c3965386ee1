/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words of a text in a form for comparison: letters and digits without case, accents and punctuation, so
 * that a text matches another edition of itself. */
#ifndef FACCIA_LIBRARY_ALIGN_TEXT_WORDS_H
#define FACCIA_LIBRARY_ALIGN_TEXT_WORDS_H

#include <stddef.h>
#include <stdint.h>

struct text_word {
    size_t from, to; /* bytes of the text */
    uint64_t hash;   /* of its normal form */
};

struct text_words {
    struct text_word *list;
    size_t count, cap;
};

/* Appends the words of UTF-8 text, with byte offsets counted from `base`. */
void text_words_add(struct text_words *tokens, const char *text, size_t size, size_t base);
void text_words_free(struct text_words *tokens);

/* First occurrence of the sequence at or after `from`, or SIZE_MAX. */
size_t text_words_find(const struct text_words *in, const struct text_word *sequence, size_t count,
                       size_t from);

/* Number of leading words of the sequence that match at a place, and of trailing words that match just
 * before one. */
size_t text_words_from(const struct text_words *in, size_t at, const struct text_words *sequence);
size_t text_words_up_to(const struct text_words *in, size_t at, const struct text_words *sequence);

/* Number of words in the best match of the sequence, and its place in *at. */
size_t text_words_longest(const struct text_words *in, const struct text_word *sequence, size_t count,
                          size_t *at);

#endif
