/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the text of a recording is read before a voice speaks it for alignment: the same numbers, signs, short
 * forms and lexicons as in speech. */
#ifndef FACCIA_LIBRARY_ALIGN_TEXT_READING_H
#define FACCIA_LIBRARY_ALIGN_TEXT_READING_H

#include "server/library/align/reference.h"

struct lexicons;
struct normalizers;

struct text_reading {
    const struct normalizers *normalizers;
    const struct lexicons *lexicons; /* may be NULL */
    const char *lang;                /* BCP 47 */
};

/* Loads the rules of the folder `normalization` and the lexicons of the recording `sound` in the folder of
 * the library; a faulty lexicon is left out. lang is unset. NULL: there are no rules. */
struct text_reading *text_reading_open(const char *normalization, const char *library, const char *sound);
void text_reading_free(struct text_reading *reading); /* only what was opened */

/* Suits reference_slot.read; ctx: struct text_reading. */
void text_reading_read(const void *ctx, const char *text, size_t size, struct reference_reading *out);

#endif
