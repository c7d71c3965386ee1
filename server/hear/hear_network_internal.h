/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a network consists of, for its reader and those who run it. */
#ifndef FACCIA_HEAR_HEAR_NETWORK_INTERNAL_H
#define FACCIA_HEAR_HEAR_NETWORK_INTERNAL_H

#include "server/hear/hear_network.h"

enum { HEAR_LAYERS = 2, HEAR_VOICE_PARTS = 3 };

/* outputs = bias + weight inputs; weight row by row. */
struct hear_affine {
    size_t inputs, outputs;
    const float *weight, *bias; /* in the network's values */
};

struct hear_network {
    size_t taps, middle, size, head_count;
    unsigned delays[HEAR_HEADS_MOST];
    struct hear_affine conv, input[HEAR_LAYERS], hidden[HEAR_LAYERS], heads[HEAR_HEADS_MOST],
        mouths[HEAR_HEADS_MOST];
    /* A voice's, a row each: the memory, its running mean, and how far from that it lies of late. Their
     * products and voice_bias are added. */
    const float *voice, *voice_bias;
    float *values;
};

#endif
