/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joins what several voices said into one sentence's audio, as if one breath had said it. */
#ifndef FACCIA_VOICE_SENTENCE_AUDIO_JOIN_H
#define FACCIA_VOICE_SENTENCE_AUDIO_JOIN_H

#include "server/voice/sentence_audio.h"

struct join_piece {
    struct sentence_audio *u; /* the join takes it over */
    bool speech;              /* silence at its ends goes, where it meets another piece */
    bool pauses;              /* but a pause is due after it: some of it stays */
};

/* What stays of the silence at each side of a joint, ms: in the flow of words, and where a pause is due. */
enum { JOIN_GAP_MS = 15, JOIN_PAUSE_MS = 180 };

/* At least one piece. Its language is that of the longest speech; cues, and its place in the input, are the
 * caller's. */
struct sentence_audio *join(struct join_piece *pieces, size_t count, uint32_t sample_rate);

#endif
