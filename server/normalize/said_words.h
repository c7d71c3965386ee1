/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words as spoken, without punctuation. */
#ifndef FACCIA_NORMALIZE_SAID_WORDS_H
#define FACCIA_NORMALIZE_SAID_WORDS_H

#include "server/base/buf.h"
#include "server/markup/score.h"

/* Appends the words of a text, separated by spaces. */
void said_words(const char *text, size_t size, struct buf *out);

/* Appends lines "WORD tab SOURCE newline" for a part: a verbatim part gives a line for each word, any
 * other part gives one line for all of its words. text: the part's text. */
void said_words_beside(const char *text, const char *input, const struct score_part *part, struct buf *out);

#endif
