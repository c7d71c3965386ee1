/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What sound is like, every 10 ms: how much of it is in each of 32 bands of the mel scale, against how loud
 * and of what colour it has been so far. Nothing of what comes later is in it. */
#ifndef FACCIA_HEAR_HEAR_FEATURES_H
#define FACCIA_HEAR_HEAR_FEATURES_H

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

#endif
