/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cues get their times from the words of the sentence's audio that they lie over. */
#ifndef FACCIA_VOICE_CUE_TIMES_H
#define FACCIA_VOICE_CUE_TIMES_H

#include "server/voice/plan.h"
#include "server/voice/sentence_audio.h"

/* Gives the sentence's audio, which has its words already, the cues of the plan. Once only. */
void cue_times_set(struct sentence_audio *u, const struct plan *plan);

/* Adds the score's cues that have a time instead of a place, as far as they lie in the sentence's audio,
 * which begins at `start` s of its text's clock. */
void cues_add_timed(struct sentence_audio *u, const struct score *score, double start);

#endif
