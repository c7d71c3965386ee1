/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mixes the channels of a sound to one. A plain mean would silence a recording whose second channel is the
 * inverse of the first (a balanced line plugged in as stereo, a miswired microphone), so such a channel is
 * inverted before it is added. */
#ifndef FACCIA_BASE_MIXDOWN_H
#define FACCIA_BASE_MIXDOWN_H

#include <stdbool.h>
#include <stddef.h>

enum { MIXDOWN_CHANNELS_MAX = 16 };

/* Zeroed at first. The result does not depend on how frames are divided into calls. */
struct mixdown {
    struct {
        double energy, with, rest; /* energy of the channel, its product with the sum of the channels before
                                      it, energy of that sum */
        size_t heard;              /* frames in which neither the channel nor the sum is zero */
        bool inverted;
    } channels[MIXDOWN_CHANNELS_MAX];
};

/* Returns the mean of a frame's channels (at most MIXDOWN_CHANNELS_MAX). Replaces NaN and infinity with 0. */
double mixdown_frame(struct mixdown *m, const float *frame, unsigned channels);

#endif
