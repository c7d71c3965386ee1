/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plain text: sentences end at . ? ! … (and their like in other scripts) and at blank lines. */
#ifndef FACCIA_MARKUP_PLAIN_H
#define FACCIA_MARKUP_PLAIN_H

#include "server/markup/markup_rules.h"
#include "server/markup/score.h"
#include <stdint.h>

int plain_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
               struct error *e);

/* Length in bytes of the sentence at the head of text[0..size), with its closing marks and the white space
 * after it. At most PLAIN_SENTENCE_BYTES, cut at a comma or a space where a longer one has any, so that
 * speech can begin early; the rules may ask for shorter ones, cut at a comma. */
enum { PLAIN_SENTENCE_BYTES = 400 };
size_t plain_sentence(const char *text, size_t size, const struct markup_rules *rules);

/* What plain_sentence gives of a text that is still being written (rules->more) when what follows could
 * change where its sentence ends. What it gives otherwise holds whatever follows. */
#define PLAIN_UNKNOWN SIZE_MAX

/* Whether text[0..size) looks like whole sentences, so that nothing more need be awaited: the last one ends
 * with its mark, which is not that of an abbreviation or a number. */
bool plain_seems_ended(const char *text, size_t size, const struct markup_rules *rules);

#endif
