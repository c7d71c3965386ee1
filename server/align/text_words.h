/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of a text as what they are compared by: letters and digits without case, accents and
 * punctuation, so that a text finds its place in another edition of itself. */
#ifndef FACCIA_ALIGN_TEXT_WORDS_H
#define FACCIA_ALIGN_TEXT_WORDS_H

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

/* Adds the words of UTF-8 text, their bytes counted from `base`. */
void text_words_add(struct text_words *tokens, const char *text, size_t size, size_t base);
void text_words_free(struct text_words *tokens);

/* The first place at or after `from` where the sequence stands, or SIZE_MAX. */
size_t text_words_find(const struct text_words *in, const struct text_word *sequence, size_t count,
                       size_t from);

/* How many of its first words stand at a place, and how many of its last just before one. */
size_t text_words_from(const struct text_words *in, size_t at, const struct text_words *sequence);
size_t text_words_up_to(const struct text_words *in, size_t at, const struct text_words *sequence);

/* How many words of the sequence stand at the place where most of it does, and that place in *at. */
size_t text_words_longest(const struct text_words *in, const struct text_word *sequence, size_t count,
                          size_t *at);

#endif
