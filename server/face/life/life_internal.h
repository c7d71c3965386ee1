/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the life layer. Random numbers depend only on the seed, their purpose and their index. */
#ifndef FACCIA_FACE_LIFE_INTERNAL_H
#define FACCIA_FACE_LIFE_INTERNAL_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct shifts;
struct prosody;

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

/* Mean 0, deviation 1, never beyond 3: the sum of three uniform numbers. */
static inline double dice_normal(struct dice *d) {
    uint64_t bits = dice_bits(d), mask = 0x1FFFFF;
    return (double)((bits & mask) + ((bits >> 21) & mask) + ((bits >> 42) & mask)) * 0x1p-20 - 3;
}

/* Log-normal: median, and deviation of the logarithm. */
static inline double dice_log_normal(struct dice *d, double median, double deviation) {
    return median * exp(deviation * dice_normal(d));
}

static inline double life_clip(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

/* 0..1 with zero speed and acceleration at both ends. */
static inline double life_smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * x * (x * (x * 6 - 15) + 10);
}

/* Continuous movements: sway of the head, drift of the eyes, breath. */

enum { NOISE_CHANNELS = 5 };

/* Smooth noise in several channels at one frequency; caches the slopes of the last period. */
struct noise {
    uint64_t seed;
    double hz;
    double whole; /* period of the phase; negative = none */
    double a[NOISE_CHANNELS], b[NOISE_CHANNELS];
};

/* Breathing at rest, 14 a minute, with variation. */
struct breath {
    uint64_t seed;
    double whole, start, in, out, depth;
};

/* Constants of eyes, lids and head. */

#define DEGREE 1745.33 /* in FAP angle units, 1e-5 rad */

/* The lids meet after IRISD in total: 1024 FAP units. They follow the eye vertically, the upper one nearly
 * fully (on an eyeball of twice the iris's diameter, 1 degree is 1024 * pi / 180 units). */
#define LID_UPPER 940
#define LID_LOWER 84
#define LID_UPPER_FOLLOWS 15.0 /* FAP units per degree */
#define LID_LOWER_FOLLOWS 7.0

/* Durations of a blink, s: closing is about twice as fast as opening (C. Evinger et al., Invest. Ophthalmol.
 * Vis. Sci. 32, 1991). */
#define BLINK_CLOSING 0.085
#define BLINK_CLOSED 0.025
#define BLINK_OPENING 0.165

/* Blinks. */

/* Maximum duration of a blink, s, including slowed ones. */
#define BLINK_LONGEST 1.2

struct blink {
    double at; /* s on the layer's clock */
    float closing, closed, opening;
    float depth;    /* 1 = the lids meet */
    float lag;      /* s by which the right eye lags behind the left */
    float mark;     /* occurs if the blink rate's factor is above this */
    bool twin;      /* second of a double blink */
    bool decided;   /* occurrence and slowness are decided */
    float slowness; /* 0 = does not occur */
};

struct blinks {
    struct blink *items;
    size_t count, cap, cursor;
};

void blinks_free(struct blinks *blinks);

/* Appends a block's blinks outside speech: 17 a minute (A. R. Bentivoglio et al., Movement Disorders
 * 12, 1997), some with large glances. */
void blinks_of_block(struct blinks *blinks, uint64_t seed, int64_t block, const struct shifts *glances);

/* Moves blinks within the sentence (from..to on the clock) into its pauses and adds some to reach the 26 a
 * minute of conversation. Movements visible outside stay unchanged. */
void blinks_of_speech(struct blinks *blinks, uint64_t seed, const struct prosody *prosody, double from,
                      double to);

/* Returns how far the lids are closed, 0..1, left and right. decide returns factors of rate and length for
 * a blink that begins at that time; called once for each. */
struct blink_factors {
    double rate, length;
};
void blinks_at(struct blinks *blinks, double clock,
               struct blink_factors (*decide)(const void *ctx, double clock), const void *ctx,
               double closed[2]);

/* Shifts of gaze and posture: at certain times eyes and head move to a new position and stay there. Angles
 * in degrees with the FAPs' signs: yaw to the subject's left, pitch down, roll to the right. */

enum { GAZE_YAW, GAZE_PITCH, HEAD_PITCH, HEAD_YAW, HEAD_ROLL, SHIFT_CHANNELS };
enum { SHIFT_EYES = HEAD_PITCH }; /* lower channels belong to the eyes */

/* Maximum duration of a shift, s. */
#define SHIFT_LONGEST 1.7

/* Maximum duration of a head turn for a glance, s. */
#define SHIFT_TURN 0.75

struct shift {
    double at;                /* s on the layer's clock */
    float to[SHIFT_CHANNELS]; /* gaze direction in space, head orientation */
    float fast, slow;         /* duration for eyes and head, s; slow = 0: the head does not move */
};

/* Sorted by time. The first is the initial state. */
struct shifts {
    struct shift *items;
    size_t count, cap, cursor;
};

void shifts_add(struct shifts *shifts, const struct shift *shift);
void shifts_free(struct shifts *shifts);

/* Returns the index of the last shift begun at that time. */
size_t shifts_find(struct shifts *shifts, double clock);

/* Adds to out. Overlapping shifts are summed, so the head moves smoothly. */
void shifts_at(struct shifts *shifts, double clock, double out[SHIFT_CHANNELS]);

/* Blocks are stretches of the clock that begin and end at the neutral position (0), so that each can be
 * computed independently. Returns a block's start. */
double life_edge(uint64_t seed, int64_t block);
int64_t life_block(uint64_t seed, double clock);

/* Appends a block's shifts of gaze and posture outside speech. */
void glances_of_block(struct shifts *glances, uint64_t seed, int64_t block);
void poses_of_block(struct shifts *poses, uint64_t seed, int64_t block);

struct prosody;

/* Replaces the glances within the sentence (from..to on the clock) by those of a speaker: at the listener,
 * away at the beginning of demanding phrases, back at their ends. Movements visible outside stay
 * unchanged. */
void glances_of_speech(struct shifts *glances, uint64_t seed, const struct prosody *prosody, double from,
                       double to);

/* Gestures of a sentence: nods, tilts, brows, a breath in a pause. Each begins and ends at 0 within the
 * sentence. */

enum {
    GESTURE_PITCH, /* of the head, degrees, signs as the FAPs' */
    GESTURE_YAW,
    GESTURE_ROLL,
    GESTURE_BROW_LEFT, /* raised, FAP units */
    GESTURE_BROW_RIGHT,
    GESTURE_NOSTRILS,     /* widened, FAP units */
    GESTURE_LIPS,         /* parted, FAP units */
    GESTURE_CHANNELS = 8, /* padded for vectorisation */
};

struct gesture_curve {
    double at; /* s from the sentence's start */
    float rise, hold, fall;
    float amount[GESTURE_CHANNELS];
};

/* Level at t, 0..1. */
double gesture_curve_at(const struct gesture_curve *curve, double t);

struct gesture_curves {
    struct gesture_curve *items; /* in order of time */
    size_t count, cap, cursor;
    double longest; /* s */
};

/* Short and long gestures are kept apart, so that only a few must be examined at any time. */
struct life_gestures {
    struct gesture_curves quick, slow;
};

struct prosody;

void life_gestures_of(const struct prosody *prosody, uint64_t seed, struct life_gestures *out);
void life_gestures_free(struct life_gestures *gestures);

/* Sets out. */
void life_gestures_at(struct life_gestures *gestures, double t, float out[GESTURE_CHANNELS]);

#endif
