/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that have been spoken and may be wanted again: their audio and their tracks, which do not change.
 * Private to synthesis. */
#ifndef FACCIA_SYNTHESIS_KEPT_SPEECH_H
#define FACCIA_SYNTHESIS_KEPT_SPEECH_H

#include "server/face/track.h"

/* More than this of one utterance is not kept: the oldest goes. About 40 s of speech. */
enum { KEPT_SPEECH_BYTES = 2 << 20 };

struct kept_sentence {
    size_t sentence;
    struct sentence_audio *audio;
    struct face_track *track;
};

/* Begins zeroed. */
struct kept_speech {
    struct kept_sentence *items; /* the oldest first; no sentence twice */
    size_t count, cap, bytes;
};

/* Shares both. */
void kept_speech_add(struct kept_speech *kept, const struct kept_sentence *sentence);

/* NULL: it is not there. Good until something is added. */
const struct kept_sentence *kept_speech_find(const struct kept_speech *kept, size_t sentence);
void kept_speech_clear(struct kept_speech *kept);

#endif
