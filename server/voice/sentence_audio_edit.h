/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes to finished sentences' audio: another sample rate, a part of one, several as one. Cues are not
 * touched, since they are timed last; but where silence comes before all, they move with their words. */
#ifndef FACCIA_VOICE_SENTENCE_AUDIO_EDIT_H
#define FACCIA_VOICE_SENTENCE_AUDIO_EDIT_H

#include "server/voice/sentence_audio.h"

/* Converts the audio, and all times with it. */
void sentence_audio_resample(struct sentence_audio *u, uint32_t sample_rate);

/* Keeps samples [from, to) and what lies in them: phones and words are cut, marks outside move to the edge.
 * An edge that was cut is faded over EDIT_FADE_MS, so that it does not click. */
enum { EDIT_FADE_MS = 10 };
void sentence_audio_cut(struct sentence_audio *u, uint32_t from, uint32_t to);

/* Puts that much silence, a pause, before the sentence. What lies at its very beginning, a mark or a cue that
 * goes on from before, stays there. */
void sentence_audio_lead_in(struct sentence_audio *u, uint32_t samples);

/* Where the sound begins and ends. Before and after it is nothing loud (18 dB below the loudest sample, 46 dB
 * where no phones are known), and no sounding phone. from == to: there is no sound. */
void sentence_audio_bounds(const struct sentence_audio *u, uint32_t *from, uint32_t *to);

struct join_piece {
    struct sentence_audio *u; /* the join takes it over */
    bool speech;              /* silence at its ends goes, where it meets another piece */
    bool pauses;              /* but a pause is due after it: some of it stays */
};

/* What stays of the silence at each side of a joint, ms: in the flow of words, and where a pause is due. */
enum { JOIN_GAP_MS = 15, JOIN_PAUSE_MS = 180 };

/* So much more silence may come before it (sentence_audio_lead_in) without its sound being moved, ms. */
enum { JOIN_ROOM_MS = 100 };

/* Joins what several voices said into one sentence's audio, as if one breath had said it: at least one piece.
 * Its language is that of the longest speech; cues, and its place in the input, are the caller's. */
struct sentence_audio *join(struct join_piece *pieces, size_t count, uint32_t sample_rate);

#endif
