/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Features of speech, frame by frame: mel-frequency cepstral coefficients (S. Davis and P. Mermelstein,
 * IEEE Trans. ASSP 28, 1980) with their slopes, normalised for the speaker. */
#ifndef FACCIA_LIBRARY_ALIGN_MFCC_H
#define FACCIA_LIBRARY_ALIGN_MFCC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    FEATURE_RATE = 16000, /* Hz */
    FEATURE_HOP = 128,    /* samples between frames: 8 ms */
    FEATURE_WINDOW = 400, /* 25 ms */
    FEATURE_CEPSTRA = 13, /* the first is the loudness */
    FEATURE_COUNT = 2 * FEATURE_CEPSTRA,
};

struct features {
    float (*frames)[FEATURE_COUNT];
    bool *silent;
    size_t count;
};

/* Computes features of mono sound. Frame k is centred at k * FEATURE_HOP / FEATURE_RATE seconds. The
 * frames cover the whole sound; there is at least one. */
void features_make(struct features *features, const int16_t *pcm, size_t samples, uint32_t rate);
void features_free(struct features *features);

#endif
