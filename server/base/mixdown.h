/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mixes the channels of a sound to one. A plain mean would silence a recording whose second channel is the
 * inverted first (a balanced line plugged in as stereo, a miswired microphone): such a channel is inverted
 * before it is added. */
#ifndef FACCIA_BASE_MIXDOWN_H
#define FACCIA_BASE_MIXDOWN_H

#include <stdbool.h>
#include <stddef.h>

enum { MIXDOWN_CHANNELS_MAX = 16 };

/* Zeroed = nothing heard. The result does not depend on how frames are divided into calls. */
struct mixdown {
    struct {
        double energy, with,
            rest;     /* of the channel, of the product with the channels before it, and of those */
        size_t heard; /* frames in which both sound */
        bool inverted;
    } channels[MIXDOWN_CHANNELS_MAX];
};

/* Mean of a frame's channels (at most MIXDOWN_CHANNELS_MAX). Replaces NaN and infinity with 0. */
double mixdown_frame(struct mixdown *m, const float *frame, unsigned channels);

#endif
