/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers in words, by ICU's rules for a language (CLDR) or by rules of the language's file. */
#ifndef FACCIA_NORMALIZE_SPELLOUT_H
#define FACCIA_NORMALIZE_SPELLOUT_H

#include "server/base/buf.h"
#include <jansson.h>
#include <stdbool.h>

/* Not thread-safe: its owner locks it. */
struct spellout;

/* From the member "spellout" of a language's file, which has to outlive it. NULL with a sentence in message
 * (cap bytes) when ICU cannot read it. */
struct spellout *spellout_new(const json_t *spellout, char *message, size_t cap);
void spellout_free(struct spellout *spellout);

/* Adds a whole number (digits only) in the words of a form: "cardinal", "cardinal-f", "ordinal"... False when
 * there is no such form, or the number is too large. */
bool spellout_whole(struct spellout *spellout, const char *form, const char *digits, struct buf *out);

/* Adds each digit by its name, with spaces between. */
void spellout_digits(struct spellout *spellout, const char *digits, struct buf *out);

#endif
