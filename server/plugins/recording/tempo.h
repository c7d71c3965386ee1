/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes the tempo of a recording without its pitch (libsonic: whole pitch periods are removed or
 * repeated), with the times of its phones and words. */
#ifndef FACCIA_PLUGINS_RECORDING_TEMPO_H
#define FACCIA_PLUGINS_RECORDING_TEMPO_H

#include "server/voice/sentence_audio.h"

#define TEMPO_MIN 0.25
#define TEMPO_MAX 4.0

/* Speed from a sample on until the next change. */
struct tempo_change {
    uint32_t from; /* sample; 0 for the first one */
    double speed;  /* TEMPO_MIN to TEMPO_MAX */
};

/* Zero-initialised: no change. */
struct tempo {
    struct tempo_change *changes; /* sorted by sample */
    size_t count, cap;
    double scale; /* correction for rounding to whole periods, close to 1; 0 = not applied yet */
};

/* Sets the speed, clipped to the range, from that sample on, which must not be before earlier ones. */
void tempo_add(struct tempo *tempo, uint32_t from, double speed);
void tempo_free(struct tempo *tempo);

/* Stretches the sound, and moves its phones and words. */
void tempo_apply(struct tempo *tempo, struct sentence_audio *u);

/* Maps a sample of the original to the stretched audio u. Call after tempo_apply. */
uint32_t tempo_at(const struct tempo *tempo, const struct sentence_audio *u, uint64_t sample);

#endif
