/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stretch of a recording faster or slower, its pitch as it was (libsonic: whole pitch periods are left out
 * or said again), with the times of what is said in it. */
#ifndef FACCIA_PLUGINS_RECORDING_TEMPO_H
#define FACCIA_PLUGINS_RECORDING_TEMPO_H

#include "server/voice/sentence_audio.h"

#define TEMPO_MIN 0.25
#define TEMPO_MAX 4.0

/* From that sample on, until the next change, so many times as fast. */
struct tempo_change {
    uint32_t from; /* sample; of the first one 0 */
    double speed;  /* TEMPO_MIN to TEMPO_MAX */
};

/* Begins zeroed: then nothing is changed. */
struct tempo {
    struct tempo_change *changes; /* in the order of the samples */
    size_t count, cap;
    double scale; /* what libsonic's whole periods make of the times, close to 1; 0 = not applied yet */
};

/* From that sample on (not before those added so far) that speed, in the range. */
void tempo_add(struct tempo *tempo, uint32_t from, double speed);
void tempo_free(struct tempo *tempo);

/* Stretches the sound, and moves its phones and words. */
void tempo_apply(struct tempo *tempo, struct sentence_audio *u);

/* Where a sample of the sound before lies in that after, once it has been applied; u: the latter. */
uint32_t tempo_at(const struct tempo *tempo, const struct sentence_audio *u, uint64_t sample);

#endif
