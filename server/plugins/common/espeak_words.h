/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words: from espeak-ng's word events, whose lengths stop at apostrophes and which split numbers and
 * addresses, to stretches of the text that a reader would call words. */
#ifndef FACCIA_PLUGINS_COMMON_ESPEAK_WORDS_H
#define FACCIA_PLUGINS_COMMON_ESPEAK_WORDS_H

#include "server/plugins/common/espeak_text.h"

struct es_word {
    uint32_t start;       /* sample */
    size_t position;      /* character of the text, 0-based */
    bool empty;           /* reported without a length: a word all the same if letters follow */
    uint32_t span;        /* set by es_words_locate */
    size_t offset, bytes; /* in the span's text; bytes 0 = part of the word before */
};

struct es_words {
    struct es_word *list;
    size_t count, cap;
};

/* Finds the place of each word in its span. */
void es_words_locate(struct es_words *words, const struct es_text *text,
                     const struct faccia_sentence *sentence);

#endif
