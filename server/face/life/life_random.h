/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chance for the life layer: numbers that depend on nothing but the seed, what they are for, and which one of
 * it. Private to life*.c, as are the curves. */
#ifndef FACCIA_FACE_LIFE_LIFE_RANDOM_H
#define FACCIA_FACE_LIFE_LIFE_RANDOM_H

#include <math.h>
#include <stdint.h>

enum dice_use {
    DICE_EDGE,
    DICE_GLANCES,
    DICE_POSES,
    DICE_BLINKS,
    DICE_NOISE,
    DICE_BREATH,
    DICE_ASYMMETRY,
    DICE_PLAN,
    DICE_GESTURES,
    DICE_NODS,
    DICE_USES,
};

struct dice {
    uint64_t state;
};

/* splitmix64 (S. Vigna, public domain algorithm). */
static inline uint64_t dice_mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline struct dice dice_of(uint64_t seed, enum dice_use use, int64_t index) {
    uint64_t which = (uint64_t)index * DICE_USES + use;
    return (struct dice){dice_mix(seed + 0x9E3779B97F4A7C15u * (which + 1))};
}

static inline uint64_t dice_bits(struct dice *d) {
    return dice_mix(d->state += 0x9E3779B97F4A7C15u);
}

/* 0 <= x < 1 */
static inline double dice_roll(struct dice *d) {
    return (double)(dice_bits(d) >> 11) * 0x1p-53;
}

static inline double dice_between(struct dice *d, double low, double high) {
    return low + (high - low) * dice_roll(d);
}

/* Mean 0, deviation 1, never beyond 3: the sum of three even numbers. */
static inline double dice_normal(struct dice *d) {
    uint64_t bits = dice_bits(d), mask = 0x1FFFFF;
    return (double)((bits & mask) + ((bits >> 21) & mask) + ((bits >> 42) & mask)) * 0x1p-20 - 3;
}

/* The logarithm is normal: median, and deviation of the logarithm. */
static inline double dice_log_normal(struct dice *d, double median, double deviation) {
    return median * exp(deviation * dice_normal(d));
}

static inline double life_clip(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

/* 0..1 with no speed and no acceleration at its ends. */
static inline double life_smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * x * (x * (x * 6 - 15) + 10);
}

#endif
