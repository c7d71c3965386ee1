/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers: each adds its part of the face at a time. */
#ifndef FACCIA_FACE_FACE_LAYER_H
#define FACCIA_FACE_FACE_LAYER_H

#include "protocol/fap.h"
#include <stddef.h>

/* Adds its part to the values at time t (s from the sentence's start). faps[n] is FAP n in FAP units, as
 * reals. It belongs to one placement of a sentence, and may remember where it was asked last. */
struct face_layer {
    void (*add)(void *self, double t, double faps[FAP_COUNT + 1]);
    void (*free)(void *self);
    void *self;
};

/* Where somebody who samples a speech layer has come: a help, no part of what is sampled. Begins as zeros. */
enum { SPEECH_CURSORS = 16 };
struct speech_cursor {
    size_t at[SPEECH_CURSORS];
};

/* What an engine makes: the mouth's part, immutable, so that many may sample it, each with a cursor. */
struct speech_layer {
    void (*add)(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]);
    void (*free)(void *self);
    void *self;
};

#endif
