/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The life layer: blinks, saccades and gaze, head motion tied to the speech's prosody, breathing, small
 * asymmetries. A function of the seed, the clock and the utterance alone, so it runs on over the utterances
 * of a stream and the same seed gives the same face. */
#ifndef FACCIA_FACE_LIFE_H
#define FACCIA_FACE_LIFE_H

#include "server/face/track.h"

/* How the expressions change life at a time of the utterance; may be NULL. */
struct life_influence {
    void (*at)(void *ctx, double t, struct liveliness *out);
    void *ctx;
};

/* u = NULL: nobody speaks. options->begin: the utterance's start on the layer's clock, s. The clock's first
 * second fades in from the neutral face. */
struct face_layer life_layer(const struct face_options *options, const struct utterance *u,
                             struct life_influence influence);

#endif
