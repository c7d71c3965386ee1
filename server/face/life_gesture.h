/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gestures of an utterance: nods, tilts, brows, a breath taken in a pause. Each begins and ends at nothing
 * within the utterance. Private to life*.c. */
#ifndef FACCIA_FACE_LIFE_GESTURE_H
#define FACCIA_FACE_LIFE_GESTURE_H

#include <stddef.h>
#include <stdint.h>

enum {
    GESTURE_PITCH, /* of the head, degrees, signs as the FAPs' */
    GESTURE_YAW,
    GESTURE_ROLL,
    GESTURE_BROW_LEFT, /* raised, FAP units */
    GESTURE_BROW_RIGHT,
    GESTURE_NOSTRILS, /* widened, FAP units */
    GESTURE_LIPS,     /* parted, FAP units */
    GESTURE_CHANNELS,
};

/* The longest, s. */
#define GESTURE_LONGEST 6.0

struct gesture_curve {
    double at; /* s from the utterance's start */
    float rise, hold, fall;
    float amount[GESTURE_CHANNELS];
};

struct gesture_curves {
    struct gesture_curve *items; /* in order of time */
    size_t count, cap, cursor;
};

struct prosody;

void gesture_curves_of(const struct prosody *prosody, uint64_t seed, double begin,
                       struct gesture_curves *out);
void gesture_curves_free(struct gesture_curves *curves);

/* Sets out. */
void gesture_curves_at(struct gesture_curves *curves, double t, double out[GESTURE_CHANNELS]);

#endif
