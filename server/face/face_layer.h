/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers: each adds its part of the face at a time. */
#ifndef FACCIA_FACE_FACE_LAYER_H
#define FACCIA_FACE_FACE_LAYER_H

#include "protocol/fap.h"
#include <stddef.h>

/* Adds its part to the values at time t (s from the sentence's start). faps[n] is FAP n in FAP units, as
 * reals. A layer belongs to one placement of a sentence and may cache its last position. */
struct face_layer {
    void (*add)(void *self, double t, double faps[FAP_COUNT + 1]);
    void (*free)(void *self);
    void *self;
};

/* Search positions of a caller that samples a speech layer: a cache that does not affect the result.
 * Zero-initialised. */
enum { SPEECH_CURSORS = 16 };
struct speech_cursor {
    size_t at[SPEECH_CURSORS];
};

/* An engine's result: the mouth's part. Immutable, so that several callers can sample it, each with its
 * own cursor. */
struct speech_layer {
    void (*add)(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]);
    void (*free)(void *self);
    void *self;
};

#endif
