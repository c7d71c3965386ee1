/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life/life.h"
#include "server/base/mem.h"
#include "server/face/life/life_internal.h"
#include "server/face/life/life_prosody.h"
#include <stdlib.h>

/* Adults at rest breathe 12 to 20 times a minute and take longer to breathe out than in. */
#define BREATH_SECONDS 4.3
#define BREATH_IN 1.5
#define BREATH_OUT 1.9

static struct noise noise_of(uint64_t seed, double hz) {
    return (struct noise){.seed = seed, .hz = hz, .whole = -1};
}

/* Sets out to -1..1, smooth to the second derivative. clock >= 0. */
static void noise_at(struct noise *n, double clock, double out[NOISE_CHANNELS]) {
    double phase = clock * n->hz, whole = floor(phase), x = phase - whole;
    if (whole != n->whole) {
        struct dice before = dice_of(n->seed, DICE_NOISE, (int64_t)whole),
                    after = dice_of(n->seed, DICE_NOISE, (int64_t)whole + 1);
        for (int c = 0; c < NOISE_CHANNELS; c++) {
            n->a[c] = dice_between(&before, -1, 1);
            n->b[c] = dice_between(&after, -1, 1);
        }
        n->whole = whole;
    }
    /* gradient noise: 0 with a random slope at each whole phase */
    double s = x * x * x * (x * (x * 6 - 15) + 10), left = 2 * x * (1 - s), right = 2 * (x - 1) * s;
    for (int c = 0; c < NOISE_CHANNELS; c++)
        out[c] = left * n->a[c] + right * n->b[c];
}

/* Returns 0 (breathed out) .. 1. clock >= 0. */
static double breath_at(struct breath *b, double clock) {
    double phase = clock / BREATH_SECONDS, whole = floor(phase);
    if (whole != b->whole || b->depth <= 0) {
        struct dice d = dice_of(b->seed, DICE_BREATH, (int64_t)whole);
        double stretch = dice_between(&d, 0.75, 1.1);
        b->whole = whole;
        b->in = BREATH_IN * stretch;
        b->out = BREATH_OUT * stretch;
        b->start = BREATH_SECONDS * whole + dice_roll(&d) * (BREATH_SECONDS - b->in - b->out);
        b->depth = dice_between(&d, 0.6, 1);
    }
    double since = clock - b->start;
    return b->depth *
           (since < b->in ? life_smooth(since / b->in) : 1 - life_smooth((since - b->in) / b->out));
}

/* Sway of the head, degrees each way, and the additional sway in speech. */
#define SWAY_HZ 0.4 /* also of the eyes' drift */
#define SWAY_PITCH 0.5
#define SWAY_YAW 0.8
#define SWAY_ROLL 0.45
#define SWAY_SPEAKING 0.5

/* Drift of fixations, degrees. */
#define DRIFT 0.15

#define BREATH_PITCH (-0.35) /* degrees: breathing in lifts the head */
#define BREATH_NOSTRILS 14   /* FAP units */

/* Asymmetry of the face, FAP units: brows, lids, mouth corners at rest. */
#define UNEVEN_BROW 12
#define UNEVEN_LID 18
#define UNEVEN_CORNER 9

#define FADE_IN 1.0
#define REST_FADE 0.5 /* s at the sentence's start and end */
#define STRENGTH_MOST 2.0

/* Shifts and blinks of a stretch of the clock. */
struct window {
    double from, to;
    struct shifts glances, poses;
    struct blinks blinks;
};

struct life {
    uint64_t seed;
    double strength, begin, end; /* of the sentence, s on the clock; end = begin: no sentence */
    struct life_influence influence;
    struct window speech, now; /* the sentence's window, and that of the last block sampled */
    struct life_gestures gestures;
    struct noise noise;
    struct breath breath;
    double brow, lid, corner; /* asymmetry, FAP units: half on each side */
};

static void window_free(struct window *w) {
    shifts_free(&w->glances);
    shifts_free(&w->poses);
    blinks_free(&w->blinks);
    *w = (struct window){0};
}

/* Fills the window with the blocks from the one at time `from` to the one at time `to`. */
static void window_of(struct window *w, uint64_t seed, double from, double to) {
    int64_t first = life_block(seed, from), last = life_block(seed, to);
    window_free(w);
    w->from = life_edge(seed, first);
    w->to = life_edge(seed, last + 1);
    for (int64_t block = first; block <= last; block++) {
        glances_of_block(&w->glances, seed, block);
        poses_of_block(&w->poses, seed, block);
        blinks_of_block(&w->blinks, seed, block, &w->glances);
    }
}

static struct window *window_at(struct life *life, double clock) {
    if (clock >= life->speech.from && clock < life->speech.to)
        return &life->speech;
    if (clock < life->now.from || clock >= life->now.to)
        window_of(&life->now, life->seed, clock, clock);
    return &life->now;
}

static struct life_factors factors_at(const struct life *life, double clock) {
    struct life_factors l = {1, 1, 1};
    if (life->influence.at)
        life->influence.at(life->influence.ctx, clock - life->begin, &l);
    return l;
}

static struct blink_factors decide(const void *ctx, double clock) {
    const struct life *life = ctx;
    struct life_factors l = factors_at(life, clock);
    double often = life->strength < 1 ? life->strength : (1 + life->strength) / 2;
    return (struct blink_factors){often * l.blink_rate, l.blink_length};
}

/* Returns 1 outside the sentence, falling to 0 within it. */
static double rest_at(const struct life *life, double clock) {
    if (clock <= life->begin || clock >= life->end)
        return 1;
    return 1 - life_smooth((clock - life->begin) / REST_FADE) * life_smooth((life->end - clock) / REST_FADE);
}

static void add_lids(const struct life *life, struct window *w, double clock, double fade, double pitch,
                     double faps[FAP_COUNT + 1]) {
    double closed[2];
    blinks_at(&w->blinks, clock, decide, life, closed);
    for (int side = 0; side < 2; side++) {
        double shut = fade * closed[side], open = fade * (side ? -life->lid : life->lid) / 2;
        faps[19 + side] += (1 - shut) * (LID_UPPER_FOLLOWS * pitch + open) + shut * LID_UPPER;
        faps[21 + side] += (1 - shut) * -LID_LOWER_FOLLOWS * pitch + shut * LID_LOWER;
    }
}

/* Parts the lips for a breath. */
static void part_lips(double amount, double faps[FAP_COUNT + 1]) {
    static const struct {
        int fap;
        double part;
    } moves[] = {{3, 1},     {4, -0.25}, {5, -1},     {8, -0.18},  {9, -0.18},  {10, -0.75}, {11, -0.75},
                 {51, -0.2}, {52, -0.9}, {55, -0.15}, {56, -0.15}, {57, -0.65}, {58, -0.65}};
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++)
        faps[moves[i].fap] += amount * moves[i].part;
}

static void add_gestures(const float g[GESTURE_CHANNELS], double strength, double faps[FAP_COUNT + 1]) {
    for (int side = 0; side < 2; side++) {
        double brow = strength * (double)g[GESTURE_BROW_LEFT + side];
        faps[31 + side] += 0.8 * brow;
        faps[33 + side] += brow;
        faps[35 + side] += 0.9 * brow;
        faps[61 + side] += strength * (double)g[GESTURE_NOSTRILS];
    }
    if (g[GESTURE_LIPS] > 0)
        part_lips(strength * (double)g[GESTURE_LIPS], faps);
}

static void add_unevenness(const struct life *life, double fade, double rest, double faps[FAP_COUNT + 1]) {
    for (int side = 0; side < 2; side++) {
        double half = fade * (side ? -0.5 : 0.5);
        for (int n = 31; n <= 35; n += 2)
            faps[n + side] += half * life->brow;
        faps[12 + side] += half * rest * life->corner;
        faps[59 + side] += half * rest * life->corner;
    }
}

static void add(void *self, double t, double faps[FAP_COUNT + 1]) {
    struct life *life = self;
    double clock = life->begin + t;
    if (clock <= 0)
        return;
    double fade = life_smooth(clock / FADE_IN), strength = fade * life->strength;
    double rest = rest_at(life, clock), noise[NOISE_CHANNELS], at[SHIFT_CHANNELS] = {0};
    float gestures[GESTURE_CHANNELS] = {0};
    struct window *w = window_at(life, clock);
    shifts_at(&w->glances, clock, at);
    shifts_at(&w->poses, clock, at);
    noise_at(&life->noise, clock, noise);
    if (rest < 1)
        life_gestures_at(&life->gestures, t, gestures);

    double motion = strength * factors_at(life, clock).motion,
           breath = rest > 0 ? rest * breath_at(&life->breath, clock) : 0;
    double swaying = 1 + SWAY_SPEAKING * (1 - rest);
    double pitch = motion * (at[HEAD_PITCH] + (double)gestures[GESTURE_PITCH] + BREATH_PITCH * breath +
                             swaying * SWAY_PITCH * noise[HEAD_PITCH]);
    double yaw =
        motion * (at[HEAD_YAW] + (double)gestures[GESTURE_YAW] + swaying * SWAY_YAW * noise[HEAD_YAW]);
    double roll =
        motion * (at[HEAD_ROLL] + (double)gestures[GESTURE_ROLL] + swaying * SWAY_ROLL * noise[HEAD_ROLL]);
    /* The eyes keep their target while the head moves. */
    double eyes = fade * (life->strength < 1 ? life->strength : (3 + life->strength) / 4);
    double eye_yaw = eyes * (at[GAZE_YAW] + DRIFT * noise[GAZE_YAW]) - yaw,
           eye_pitch = eyes * (at[GAZE_PITCH] + DRIFT * noise[GAZE_PITCH]) - pitch;
    for (int side = 0; side < 2; side++) {
        faps[23 + side] += DEGREE * eye_yaw;
        faps[25 + side] += DEGREE * eye_pitch;
        faps[61 + side] += strength * BREATH_NOSTRILS * breath;
    }
    faps[48] += DEGREE * pitch;
    faps[49] += DEGREE * yaw;
    faps[50] += DEGREE * roll;
    add_lids(life, w, clock, fade, eye_pitch, faps);
    add_unevenness(life, strength, rest, faps);
    if (rest < 1)
        add_gestures(gestures, strength, faps);
}

static void add_nothing(void *self, double t, double faps[FAP_COUNT + 1]) {
    (void)self;
    (void)t;
    (void)faps;
}

static void life_free(void *self) {
    struct life *life = self;
    window_free(&life->speech);
    window_free(&life->now);
    life_gestures_free(&life->gestures);
    free(life);
}

static void prepare_speech(struct life *life, const struct sentence_audio *u) {
    struct prosody prosody;
    prosody_of(u, life->begin, &prosody);
    life->end = life->begin + prosody.end;
    window_of(&life->speech, life->seed, life->begin, life->end);
    glances_of_speech(&life->speech.glances, life->seed, &prosody, life->begin, life->end);
    blinks_of_speech(&life->speech.blinks, life->seed, &prosody, life->begin, life->end);
    life_gestures_of(&prosody, life->seed, &life->gestures);
    prosody_free(&prosody);
}

struct face_layer life_layer(const struct placement_options *options, const struct sentence_audio *u,
                             struct life_influence influence) {
    if (!(options->life > 0))
        return (struct face_layer){add_nothing, NULL, NULL};
    struct life *life = mem_alloc(sizeof *life);
    uint64_t seed = options->seed;
    struct dice d = dice_of(seed, DICE_ASYMMETRY, 0);
    *life = (struct life){.seed = seed,
                          .strength = fmin(options->life, STRENGTH_MOST),
                          .begin = options->begin,
                          .end = options->begin,
                          .influence = influence,
                          .noise = noise_of(seed, SWAY_HZ),
                          .breath = {.seed = seed},
                          .brow = UNEVEN_BROW * dice_between(&d, 0.4, 1),
                          .lid = UNEVEN_LID * dice_between(&d, 0.4, 1),
                          .corner = UNEVEN_CORNER * dice_between(&d, 0.4, 1)};
    uint64_t sides = dice_bits(&d);
    if (sides & 1)
        life->brow = -life->brow;
    if (sides & 2)
        life->lid = -life->lid;
    if (sides & 4)
        life->corner = -life->corner;
    if (u && u->samples)
        prepare_speech(life, u);
    return (struct face_layer){add, life_free, life};
}
