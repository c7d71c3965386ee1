/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

/* Blinks: 26 a minute in conversation, 17 at rest (Bentivoglio et al., Movement Disorders 12, 1997); about
 * 0.25 s, closing twice as fast as opening (Evinger et al., Invest. Ophthalmol. Vis. Sci. 32, 1991). One in
 * each slot of time, at random in it. */
#define BLINK_SLOT 2.6
#define BLINK_LATEST 0.75 /* of the slot */
#define BLINK_CLOSING 0.075
#define BLINK_CLOSED 0.03
#define BLINK_OPENING 0.15
#define BLINK_TWICE 0.08 /* probability of a second one at once */
#define BLINK_TWICE_AFTER 0.36
/* Upper and lower lid meet after IRISD in all: 1024 FAP units. */
#define LID_UPPER 940
#define LID_LOWER 84

#define DEGREE 1745.33 /* in FAP angle units, 1e-5 rad */
#define SWAY_HZ 0.35
#define SWAY_PITCH (0.8 * DEGREE)
#define SWAY_YAW (1.2 * DEGREE)
#define SWAY_ROLL (0.6 * DEGREE)

#define BREATH_SECONDS 4.0
#define BREATH_PITCH (0.2 * DEGREE)
#define BREATH_NOSTRILS 12 /* FAP units */

#define FADE_IN 1.0

enum stream { STREAM_BLINK, STREAM_TWICE, STREAM_PITCH, STREAM_YAW, STREAM_ROLL, STREAM_BREATH, STREAMS };

#define TAU 6.283185307179586

struct life {
    uint64_t seed;
    double begin;
};

/* 0..1 from the seed, a stream and a slot (splitmix64, S. Vigna, public domain algorithm). */
static double chance(const struct life *life, enum stream stream, int64_t slot) {
    uint64_t z = life->seed + 0x9E3779B97F4A7C15u * ((uint64_t)slot * STREAMS + stream + 1);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

static double smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

/* How far the lids are closed, since seconds after a blink's start. */
static double lid(double since) {
    if (since < BLINK_CLOSING)
        return smooth(since / BLINK_CLOSING);
    return 1 - smooth((since - BLINK_CLOSING - BLINK_CLOSED) / BLINK_OPENING);
}

static double blink(const struct life *life, double clock) {
    double closed = 0, now = floor(clock / BLINK_SLOT);
    /* A blink late in the slot before may last into this one. */
    for (int back = 0; back <= 1; back++) {
        int64_t slot = (int64_t)now - back;
        double since = clock - BLINK_SLOT * ((double)slot + BLINK_LATEST * chance(life, STREAM_BLINK, slot));
        closed = fmax(closed, lid(since));
        if (chance(life, STREAM_TWICE, slot) < BLINK_TWICE)
            closed = fmax(closed, lid(since - BLINK_TWICE_AFTER));
    }
    return closed;
}

/* Smooth noise, -1..1, one random slope per period. */
static double noise(const struct life *life, enum stream stream, double phase) {
    double whole = floor(phase), x = phase - whole;
    double a = 2 * chance(life, stream, (int64_t)whole) - 1,
           b = 2 * chance(life, stream, (int64_t)whole + 1) - 1;
    return 2 * (a * x + (b * (x - 1) - a * x) * (x * x * x * (x * (x * 6 - 15) + 10)));
}

static void add(void *self, double t, double faps[FAP_COUNT + 1]) {
    const struct life *life = self;
    double clock = life->begin + t, fade = smooth(clock / FADE_IN), lids = fade * blink(life, clock);
    double breath = sin(TAU * (clock / BREATH_SECONDS + chance(life, STREAM_BREATH, 0)));
    double pitch = fade * (SWAY_PITCH * noise(life, STREAM_PITCH, SWAY_HZ * clock) + BREATH_PITCH * breath);
    double yaw = fade * SWAY_YAW * noise(life, STREAM_YAW, SWAY_HZ * clock);
    faps[19] += LID_UPPER * lids;
    faps[20] += LID_UPPER * lids;
    faps[21] += LID_LOWER * lids;
    faps[22] += LID_LOWER * lids;
    faps[48] += pitch;
    faps[49] += yaw;
    faps[50] += fade * SWAY_ROLL * noise(life, STREAM_ROLL, SWAY_HZ * clock);
    faps[23] -= yaw;
    faps[24] -= yaw;
    faps[25] -= pitch;
    faps[26] -= pitch;
    faps[61] += fade * BREATH_NOSTRILS * breath;
    faps[62] += fade * BREATH_NOSTRILS * breath;
}

struct face_layer life_layer(const struct face_options *options, const struct utterance *u,
                             struct life_influence influence) {
    (void)u;
    (void)influence;
    struct life *life = mem_alloc(sizeof *life);
    *life = (struct life){options->seed, options->begin};
    return (struct face_layer){add, free, life};
}
