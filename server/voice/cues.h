/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cues get their times from the words of the utterance that they lie over. */
#ifndef FACCIA_VOICE_CUES_H
#define FACCIA_VOICE_CUES_H

#include "server/voice/plan.h"
#include "server/voice/utterance.h"

/* Gives the utterance, which has its words already, the cues of the plan. Once only. */
void cues_time(struct utterance *u, const struct plan *plan);

/* Adds the score's cues that have a time instead of a place, as far as they lie in the utterance, which
 * begins at `start` s of its text's clock. */
void cues_add_timed(struct utterance *u, const struct score *score, double start);

#endif
