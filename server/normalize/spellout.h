/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spells numbers in words, by ICU's rules for a language (CLDR) or by rules of the language's file. */
#ifndef FACCIA_NORMALIZE_SPELLOUT_H
#define FACCIA_NORMALIZE_SPELLOUT_H

#include "server/base/buf.h"
#include <jansson.h>
#include <stdbool.h>

/* Not thread-safe: the owner must lock it. */
struct spellout;

/* Takes the member "spellout" of a language's file, which must outlive it. Returns NULL with a sentence in
 * message (cap bytes) if ICU rejects it. */
struct spellout *spellout_new(const json_t *spellout, char *message, size_t cap);
void spellout_free(struct spellout *spellout);

/* Appends a whole number (digits only) in words of a form: "cardinal", "cardinal-f", "ordinal"... False if
 * the form does not exist or the number is too large. */
bool spellout_whole(struct spellout *spellout, const char *form, const char *digits, struct buf *out);

/* Appends the name of each digit, separated by spaces. */
void spellout_digits(struct spellout *spellout, const char *digits, struct buf *out);

#endif
