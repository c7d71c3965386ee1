/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mixes the channels of a sound to one. The plain mean silences a recording whose second channel is the first
 * one inverted (a balanced line plugged in as stereo, a miswired microphone): such a channel is turned over
 * before it is added. */
#ifndef FACCIA_BASE_MIXDOWN_H
#define FACCIA_BASE_MIXDOWN_H

#include <stdbool.h>
#include <stddef.h>

enum { MIXDOWN_CHANNELS_MAX = 16 };

/* All zeros = nothing heard so far. The result depends on the frames alone, not on how they are divided into
 * calls. */
struct mixdown {
    struct {
        double energy, with, rest; /* of the channel, of both multiplied, of the channels before it */
        size_t heard;              /* frames in which both sound */
        bool inverted;
    } channels[MIXDOWN_CHANNELS_MAX];
};

/* The mean of one frame's channels (at most MIXDOWN_CHANNELS_MAX). What is no number counts as 0. */
double mixdown_frame(struct mixdown *m, const float *frame, unsigned channels);

#endif
