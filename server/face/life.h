/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The life layer: blinks, a little head sway, breathing; the eyes stay on the listener. A function of the
 * seed and the clock alone, so it runs on over the utterances of a stream and the same seed gives the same
 * face. */
#ifndef FACCIA_FACE_LIFE_H
#define FACCIA_FACE_LIFE_H

#include "server/face/track.h"

/* begin: the utterance's start on the layer's clock, s. The clock's first second fades in from the neutral
 * face. */
struct face_layer life_layer(uint64_t seed, double begin);

#endif
