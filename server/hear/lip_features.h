/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What sound is like, every 10 ms: how much of it is in each of 32 bands of the mel scale, against how loud
 * and of what colour it has been so far. Nothing of what comes later is in it. */
#ifndef FACCIA_HEAR_LIP_FEATURES_H
#define FACCIA_HEAR_LIP_FEATURES_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    HEAR_HOP = 160,    /* samples of HEAR_RATE from one frame to the next */
    HEAR_WINDOW = 400, /* 25 ms; frame k is of the samples from k * HEAR_HOP on */
    HEAR_FFT = 512,
    HEAR_BANDS = 32,
    HEAR_FEATURES = HEAR_BANDS + 1, /* the last is the loudness */
};

struct hear_features;

/* take gets each frame as soon as its last sample is there. */
struct hear_features *hear_features_new(void (*take)(void *ctx, const float frame[HEAR_FEATURES]), void *ctx);
void hear_features_free(struct hear_features *features);
void hear_features_write(struct hear_features *features, const float *samples, size_t count);

/* Sound of any rate and number of channels, as it comes, brought to what the features want: 16 kHz, mono,
 * without its mean. In what pieces it comes makes no difference to a single bit. */

enum {
    HEAR_RATE = 16000,
    HEAR_RATE_LEAST = 8000,
    HEAR_RATE_MOST = 96000,
    HEAR_CHANNELS_MOST = 8,
};

struct hear_sound;

/* take gets what has become ready, at most 20 ms at a time. NULL with *e (bad-sound) when the rate or the
 * number of channels is out of range. */
struct hear_sound *hear_sound_new(unsigned rate, unsigned channels,
                                  void (*take)(void *ctx, const float *samples, size_t count), void *ctx,
                                  struct error *e);
void hear_sound_free(struct hear_sound *sound);

/* Samples from -1 to 1, of all channels by turns; frames of one sample each. What is no number counts as
 * silence, what is louder is clipped. */
void hear_sound_write(struct hear_sound *sound, const float *samples, size_t frames);

/* There is no more: gives what is left. */
void hear_sound_end(struct hear_sound *sound);

#endif
