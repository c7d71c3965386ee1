/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shifts of gaze and of posture: at certain times the eyes jump and the head turns to a new place, where they
 * stay. Private to life*.c. Angles in degrees, signs as the FAPs': yaw to the subject's left, pitch down,
 * roll to the right. */
#ifndef FACCIA_FACE_LIFE_LIFE_SHIFT_H
#define FACCIA_FACE_LIFE_LIFE_SHIFT_H

#include <stddef.h>
#include <stdint.h>

enum { GAZE_YAW, GAZE_PITCH, HEAD_PITCH, HEAD_YAW, HEAD_ROLL, SHIFT_CHANNELS };
enum { SHIFT_EYES = HEAD_PITCH }; /* channels below this one belong to the eyes */

/* The longest that a shift takes, s. */
#define SHIFT_LONGEST 1.7

/* What a head turn for a glance takes at most, s. */
#define SHIFT_TURN 0.75

struct shift {
    double at;                /* s on the layer's clock */
    float to[SHIFT_CHANNELS]; /* where the eyes look in space, where the head points */
    float fast, slow;         /* s that eyes and head take; slow = 0: the head does not move */
};

/* In order of time. The first one is the state from which the others start. */
struct shifts {
    struct shift *items;
    size_t count, cap, cursor;
};

void shifts_add(struct shifts *shifts, const struct shift *shift);
void shifts_free(struct shifts *shifts);

/* Index of the last shift that has begun at that time. */
size_t shifts_find(struct shifts *shifts, double clock);

/* Adds to out. Shifts that overlap add up, so the head's way stays smooth. */
void shifts_at(struct shifts *shifts, double clock, double out[SHIFT_CHANNELS]);

/* A block is a stretch of the clock that begins and ends with all at home (0), so that each can be made
 * without the others. Its bounds. */
double life_edge(uint64_t seed, int64_t block);
int64_t life_block(uint64_t seed, double clock);

/* Appends the shifts of gaze, and of posture, that a block has while nobody speaks. */
void glances_of_block(struct shifts *glances, uint64_t seed, int64_t block);
void poses_of_block(struct shifts *poses, uint64_t seed, int64_t block);

struct prosody;

/* Replaces the glances within the sentence (from..to on the clock) by those of somebody who speaks: at the
 * listener, away at the beginning of what takes thought, back at the ends of phrases. Everything outside, and
 * what can be seen outside, stays. */
void glances_of_speech(struct shifts *glances, uint64_t seed, const struct prosody *prosody, double from,
                       double to);

#endif
