/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What never rests: sway of the head, drift of the eyes, breath. Private to life*.c. */
#ifndef FACCIA_FACE_LIFE_LIFE_NOISE_H
#define FACCIA_FACE_LIFE_LIFE_NOISE_H

#include "server/face/life/life_random.h"

enum { NOISE_CHANNELS = 5 };

/* Smooth noise in some channels at one frequency; keeps the slopes of the period that was asked for last. */
struct noise {
    uint64_t seed;
    double hz;
    double whole; /* of the phase; below 0: none yet */
    double a[NOISE_CHANNELS], b[NOISE_CHANNELS];
};

struct noise noise_of(uint64_t seed, double hz);

/* clock >= 0. -1..1, smooth to the second derivative. */
void noise_at(struct noise *noise, double clock, double out[NOISE_CHANNELS]);

/* Breaths of somebody at rest, 14 a minute, none like the other. */
struct breath {
    uint64_t seed;
    double whole, start, in, out, depth;
};

/* clock >= 0. 0 = breathed out .. 1. */
double breath_at(struct breath *breath, double clock);

#endif
