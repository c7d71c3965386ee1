/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads plain text. Sentences end at . ? ! … (and equivalents in other scripts) and at blank lines. */
#ifndef FACCIA_MARKUP_PLAIN_H
#define FACCIA_MARKUP_PLAIN_H

#include "server/markup/markup_rules.h"
#include "server/markup/score.h"
#include <stdint.h>

int plain_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
               struct error *e);

/* Returns the length in bytes of the first sentence of text[0..size), including closing marks and trailing
 * white space. Longer sentences than PLAIN_SENTENCE_BYTES are cut at a comma or space if possible, so that
 * speech can begin early. The rules may ask for shorter ones, cut at a comma. */
enum { PLAIN_SENTENCE_BYTES = 400 };
size_t plain_sentence(const char *text, size_t size, const struct markup_rules *rules);

/* Returned by plain_sentence if the text is unfinished (rules->more) and a continuation could move the
 * sentence's end. Any other result is final. */
#define PLAIN_UNKNOWN SIZE_MAX

/* True if text[0..size) looks like whole sentences, so that there is no need to wait for more: it ends
 * with a sentence mark that does not belong to an abbreviation or number. */
bool plain_seems_ended(const char *text, size_t size, const struct markup_rules *rules);

#endif
