/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What sound is like, every 10 ms: how much of it is in each of 32 bands of the mel scale, against how loud
 * and of what colour it has been so far. Nothing of what comes later is in it. */
#ifndef FACCIA_HEAR_LIP_FEATURES_H
#define FACCIA_HEAR_LIP_FEATURES_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    LIP_HOP = 160,    /* samples of LIP_RATE from one frame to the next */
    LIP_WINDOW = 400, /* 25 ms; frame k is of the samples from k * LIP_HOP on */
    LIP_FFT = 512,
    LIP_BANDS = 32,
    LIP_FEATURES = LIP_BANDS + 1, /* the last is the loudness */
};

struct lip_features;

/* take gets each frame as soon as its last sample is there. */
struct lip_features *lip_features_new(void (*take)(void *ctx, const float frame[LIP_FEATURES]), void *ctx);
void lip_features_free(struct lip_features *features);
void lip_features_write(struct lip_features *features, const float *samples, size_t count);

/* Sound of any rate and number of channels, as it comes, brought to what the features want: 16 kHz, mono,
 * without its mean. In what pieces it comes makes no difference to a single bit. */

enum {
    LIP_RATE = 16000,
    LIP_RATE_LEAST = 8000,
    LIP_RATE_MOST = 96000,
    LIP_CHANNELS_MOST = 8,
};

struct lip_input;

/* take gets what has become ready, at most 20 ms at a time. NULL with *e (bad-sound) when the rate or the
 * number of channels is out of range. */
struct lip_input *lip_input_new(unsigned rate, unsigned channels,
                                void (*take)(void *ctx, const float *samples, size_t count), void *ctx,
                                struct error *e);
void lip_input_free(struct lip_input *sound);

/* Samples from -1 to 1, of all channels by turns; frames of one sample each. What is no number counts as
 * silence, what is louder is clipped. */
void lip_input_write(struct lip_input *sound, const float *samples, size_t frames);

/* There is no more: gives what is left. */
void lip_input_end(struct lip_input *sound);

#endif
