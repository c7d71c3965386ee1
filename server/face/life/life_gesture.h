/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gestures of a sentence: nods, tilts, brows, a breath taken in a pause. Each begins and ends at nothing
 * within the sentence. Private to life*.c. */
#ifndef FACCIA_FACE_LIFE_LIFE_GESTURE_H
#define FACCIA_FACE_LIFE_LIFE_GESTURE_H

#include <stddef.h>
#include <stdint.h>

enum {
    GESTURE_PITCH, /* of the head, degrees, signs as the FAPs' */
    GESTURE_YAW,
    GESTURE_ROLL,
    GESTURE_BROW_LEFT, /* raised, FAP units */
    GESTURE_BROW_RIGHT,
    GESTURE_NOSTRILS,     /* widened, FAP units */
    GESTURE_LIPS,         /* parted, FAP units */
    GESTURE_CHANNELS = 8, /* a whole number of vectors */
};

struct gesture_curve {
    double at; /* s from the sentence's start */
    float rise, hold, fall;
    float amount[GESTURE_CHANNELS];
};

/* How much of its amount there is at t, 0..1. */
double gesture_curve_at(const struct gesture_curve *curve, double t);

struct gesture_curves {
    struct gesture_curve *items; /* in order of time */
    size_t count, cap, cursor;
    double longest; /* s */
};

/* Short ones and long ones apart, so that at any time only a few have to be looked at. */
struct life_gestures {
    struct gesture_curves quick, slow;
};

struct prosody;

void life_gestures_of(const struct prosody *prosody, uint64_t seed, struct life_gestures *out);
void life_gestures_free(struct life_gestures *gestures);

/* Sets out. */
void life_gestures_at(struct life_gestures *gestures, double t, float out[GESTURE_CHANNELS]);

#endif
