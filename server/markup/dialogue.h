/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dialogue in prose: what stands in quotation marks, or after a dash that begins a paragraph, is spoken by
 * two persons in turn. A paragraph has one of them; after two paragraphs without speech the first one begins
 * again. */
#ifndef FACCIA_MARKUP_DIALOGUE_H
#define FACCIA_MARKUP_DIALOGUE_H

#include "server/markup/speaker_runs.h"

/* Finds the dialogue of text[0..size). Single quoted words without punctuation do not count as speech. */
void dialogue_find(struct speaker_runs *runs, const char *text, size_t size);

#endif
