/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words as they are said, without the marks between them. */
#ifndef FACCIA_NORMALIZE_SAID_WORDS_H
#define FACCIA_NORMALIZE_SAID_WORDS_H

#include "server/base/buf.h"
#include "server/markup/score.h"

/* Adds the words of a text, each with a space before it unless it is the first. */
void said_words(const char *text, size_t size, struct buf *out);

/* Adds lines "WORD tab SOURCE newline" for a part: one for each word that stands in the input as it is said,
 * else one for all of its words. text: the part's own. */
void said_words_beside(const char *text, const char *input, const struct score_part *part, struct buf *out);

#endif
