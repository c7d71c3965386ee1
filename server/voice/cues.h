/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cues get their times from the words of the utterance that they lie over. */
#ifndef FACCIA_VOICE_CUES_H
#define FACCIA_VOICE_CUES_H

#include "server/voice/plan.h"
#include "server/voice/utterance.h"

/* Gives the utterance, which has its words already, the cues of the plan. Once only. */
void cues_time(struct utterance *u, const struct plan *plan);

#endif
