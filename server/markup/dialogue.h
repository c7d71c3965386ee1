/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dialogue in prose: what stands in quotation marks, or after a dash that begins a paragraph. A paragraph has
 * one speaker: the person whom the narrator names (dialogue_names.c), or one of two in turn; after two
 * paragraphs without speech the first one begins again. */
#ifndef FACCIA_MARKUP_DIALOGUE_H
#define FACCIA_MARKUP_DIALOGUE_H

#include "server/markup/speaker_runs.h"

/* Finds the dialogue of text[0..size), in a language (BCP 47; NULL: not known). Single quoted words without
 * punctuation do not count as speech. Speakers who are not named are "voice-1" and "voice-2". */
void dialogue_find(struct speaker_runs *runs, const char *text, size_t size, const char *lang);

#endif
