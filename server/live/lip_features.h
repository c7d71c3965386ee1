/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Features of sound every 10 ms: energy in 32 mel bands relative to the loudness and spectrum so far. Causal:
 * uses no later sound. */
#ifndef FACCIA_LIVE_LIP_FEATURES_H
#define FACCIA_LIVE_LIP_FEATURES_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    LIP_HOP = 160,    /* samples of LIP_RATE between frames */
    LIP_WINDOW = 400, /* 25 ms; frame k covers the samples from k * LIP_HOP on */
    LIP_FFT = 512,
    LIP_BANDS = 32,
    LIP_FEATURES = LIP_BANDS + 1, /* the last is the loudness */
};

struct lip_features;

/* Calls take for each frame as soon as its last sample has arrived. */
struct lip_features *lip_features_new(void (*take)(void *ctx, const float frame[LIP_FEATURES]), void *ctx);
void lip_features_free(struct lip_features *features);
void lip_features_write(struct lip_features *features, const float *samples, size_t count);

/* Converts sound of any rate and channel count to 16 kHz mono without its mean. The result does not depend
 * on how the sound is split. */

enum {
    LIP_RATE = 16000,
    LIP_RATE_LEAST = 8000,
    LIP_RATE_MOST = 96000,
    LIP_CHANNELS_MOST = 8,
};

struct lip_input;

/* Calls take with at most 20 ms at a time. Returns NULL with *e (bad-sound) when the rate or channel count
 * is out of range. */
struct lip_input *lip_input_new(unsigned rate, unsigned channels,
                                void (*take)(void *ctx, const float *samples, size_t count), void *ctx,
                                struct error *e);
void lip_input_free(struct lip_input *sound);

/* Interleaved samples, -1..1; frames of one sample per channel. Replaces NaN and infinity with 0 and clips
 * louder samples. */
void lip_input_write(struct lip_input *sound, const float *samples, size_t frames);

/* Ends the sound and passes on the rest. */
void lip_input_end(struct lip_input *sound);

#endif
