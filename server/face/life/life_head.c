/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/life/life_internal.h"
#include "server/face/life/life_prosody.h"
#include <stdlib.h>

#define BLOCK_SECONDS 20.0
#define EDGE_SPREAD 8.0

/* Posture: interval and size of changes, degrees (standard deviations). */
#define POSE_MEDIAN 5.5
#define POSE_DEVIATION 0.6
#define POSE_PITCH 0.8
#define POSE_YAW 1.3
#define POSE_ROLL 1.0
#define POSE_SHORTEST 1.0

void shifts_add(struct shifts *shifts, const struct shift *shift) {
    shifts->items = mem_grow(shifts->items, &shifts->cap, shifts->count + 1, sizeof *shift);
    shifts->items[shifts->count++] = *shift;
}

void shifts_free(struct shifts *shifts) {
    free(shifts->items);
    *shifts = (struct shifts){0};
}

size_t shifts_find(struct shifts *shifts, double clock) {
    size_t i = shifts->cursor;
    while (i && shifts->items[i].at > clock)
        i--;
    while (i + 1 < shifts->count && shifts->items[i + 1].at <= clock)
        i++;
    return shifts->cursor = i;
}

/* Remaining fraction of a movement that started `since` seconds ago. */
static double rest(double since, double length) {
    return since < length ? 1 - life_smooth(since / length) : 0;
}

void shifts_at(struct shifts *shifts, double clock, double out[SHIFT_CHANNELS]) {
    size_t i = shifts_find(shifts, clock);
    for (int c = 0; c < SHIFT_CHANNELS; c++)
        out[c] += (double)shifts->items[i].to[c];
    for (; i && clock - shifts->items[i].at < SHIFT_LONGEST; i--) {
        const struct shift *s = &shifts->items[i];
        double eyes = rest(clock - s->at, (double)s->fast), head = rest(clock - s->at, (double)s->slow);
        for (int c = 0; eyes > 0 && c < SHIFT_EYES; c++)
            out[c] -= eyes * (double)(s->to[c] - s[-1].to[c]);
        for (int c = SHIFT_EYES; head > 0 && c < SHIFT_CHANNELS; c++)
            out[c] -= head * (double)(s->to[c] - s[-1].to[c]);
    }
}

double life_edge(uint64_t seed, int64_t block) {
    struct dice d = dice_of(seed, DICE_EDGE, block);
    return BLOCK_SECONDS * (double)block + EDGE_SPREAD * (dice_roll(&d) - 0.5);
}

int64_t life_block(uint64_t seed, double clock) {
    int64_t block = (int64_t)floor(clock / BLOCK_SECONDS);
    if (clock < life_edge(seed, block))
        return block - 1;
    return clock < life_edge(seed, block + 1) ? block : block + 1;
}

void poses_of_block(struct shifts *poses, uint64_t seed, int64_t block) {
    struct dice d = dice_of(seed, DICE_POSES, block);
    double at = life_edge(seed, block), end = life_edge(seed, block + 1) - SHIFT_LONGEST;
    shifts_add(poses, &(struct shift){.at = at});
    for (;;) {
        at += fmax(dice_log_normal(&d, POSE_MEDIAN, POSE_DEVIATION), SHIFT_LONGEST);
        struct shift s = {.at = fmin(at, end), .slow = (float)dice_between(&d, POSE_SHORTEST, SHIFT_LONGEST)};
        if (at + SHIFT_LONGEST < end) {
            s.to[HEAD_PITCH] = (float)(POSE_PITCH * dice_normal(&d));
            s.to[HEAD_YAW] = (float)(POSE_YAW * dice_normal(&d));
            s.to[HEAD_ROLL] = (float)(POSE_ROLL * dice_normal(&d));
            shifts_add(poses, &s);
        } else {
            s.at = end;
            shifts_add(poses, &s);
            return;
        }
    }
}

/* Head and brows move with the voice: nods and brow raises on prominent words (H. Graf et al., "Visual
 * prosody", FG 2002; K. Munhall et al., Psychological Science 15, 2004), a new posture with a new phrase
 * (U. Hadar et al., Human Movement Science 2, 1983). Amounts are at the lower end of theirs. */

/* Nods, degrees: for the least and the most prominent; factor per semitone. */
#define NOD_LEAST 0.8
#define NOD_MOST 3.4
#define NOD_PER_SEMITONE 0.06
#define BEAT 0.5 /* for accents that are not prominent */
#define NOD_RISE 0.2
#define NOD_FALL 0.34
#define NOD_EARLY 0.05
#define NOD_SCATTER 0.1 /* s: people's nods are near the accent, not on it; at most twice that */

/* Brows: probability by prominence, FAP units. */
#define BROW_FROM 0.5
#define BROW_CHANCE 0.7
#define BROW_LEAST 45
#define BROW_MOST 95
#define BROW_UNEVEN 0.15

/* Postures of phrases, degrees (standard deviations), and their maximum duration, s. */
#define PHRASE_PITCH 0.6
#define PHRASE_YAW 1.2
#define PHRASE_ROLL 1.0
#define PHRASE_SECONDS 4.0
#define PHRASE_RISE 0.7
#define PHRASE_FALL 0.7

/* A question: minimum rise in semitones within the last phone. */
#define QUESTION_RISE 1.2
#define QUESTION_ROLL 3.0
#define QUESTION_BROW 70

/* A breath: minimum pause, s, with time for the lips to move. */
#define BREATH_PAUSE 0.24
#define BREATH_AFTER 0.09
#define BREATH_BEFORE 0.08
#define BREATH_LONGEST 0.8
#define BREATH_PITCH (-0.6)
#define BREATH_NOSTRILS 20
#define BREATH_LIPS 34

void life_gestures_free(struct life_gestures *gestures) {
    free(gestures->quick.items);
    free(gestures->slow.items);
    *gestures = (struct life_gestures){0};
}

/* Adds a gesture that fits into 0..end, shortening its fall if needed. Returns NULL if it does not fit. */
static struct gesture_curve *add(struct gesture_curves *curves, double end, double at, double rise,
                                 double hold, double fall) {
    double room = end - at - rise - hold;
    if (at < 0 || room < 0.7 * fall)
        return NULL;
    curves->items = mem_grow(curves->items, &curves->cap, curves->count + 1, sizeof *curves->items);
    struct gesture_curve *g = &curves->items[curves->count++];
    *g = (struct gesture_curve){at, (float)rise, (float)hold, (float)fmin(fall, room), {0}};
    curves->longest = fmax(curves->longest, rise + hold + fall);
    return g;
}

static void raise_brows(struct gesture_curve *g, struct dice *d, double amount) {
    double uneven = BROW_UNEVEN * dice_normal(d) / 2;
    g->amount[GESTURE_BROW_LEFT] = (float)(amount * (1 + uneven));
    g->amount[GESTURE_BROW_RIGHT] = (float)(amount * (1 - uneven));
}

static void nod(struct gesture_curves *out, const struct accent *a, struct dice *d, double end) {
    double size = (NOD_LEAST + (NOD_MOST - NOD_LEAST) * a->weight) * (1 + NOD_PER_SEMITONE * a->pitch);
    double rise = NOD_RISE * dice_between(d, 0.9, 1.3), fall = NOD_FALL * dice_between(d, 0.9, 1.4);
    double yaw = dice_normal(d), roll = dice_normal(d), raised = dice_roll(d), amount = dice_roll(d);
    double at = a->at + life_clip(NOD_SCATTER * dice_normal(d), -2 * NOD_SCATTER, 2 * NOD_SCATTER);
    if (!a->major)
        size = BEAT * size * dice_between(d, 0.3, 1);
    struct gesture_curve *g = add(out, end, at - rise - NOD_EARLY * dice_roll(d), rise, 0, fall);
    if (g) {
        g->amount[GESTURE_PITCH] = (float)size;
        g->amount[GESTURE_YAW] = (float)(0.25 * size * yaw);
        g->amount[GESTURE_ROLL] = (float)(0.2 * size * roll);
    }
    if (!a->major || a->weight < BROW_FROM || raised > BROW_CHANCE * a->weight)
        return;
    g = add(out, end, at - rise - 2 * NOD_EARLY, rise, 0.08, fall);
    if (g)
        raise_brows(g, d, BROW_LEAST + (BROW_MOST - BROW_LEAST) * amount);
}

/* Adds postures in from..to, each held until the next. */
static void keep_turned(struct gesture_curves *out, struct dice *d, double from, double to, double end) {
    while (from < to) {
        double length = fmin(to - from, PHRASE_SECONDS * dice_between(d, 0.6, 1));
        struct gesture_curve *g = add(out, end, fmax(0, from - PHRASE_RISE / 2), PHRASE_RISE,
                                      fmax(0, length - PHRASE_RISE), PHRASE_FALL);
        double pitch = PHRASE_PITCH * dice_normal(d), yaw = PHRASE_YAW * dice_normal(d);
        double roll = PHRASE_ROLL * dice_normal(d);
        if (g) {
            g->amount[GESTURE_PITCH] = (float)pitch;
            g->amount[GESTURE_YAW] = (float)yaw;
            g->amount[GESTURE_ROLL] = (float)roll;
        }
        from += length;
    }
}

static void breathe(struct gesture_curves *out, struct dice *d, double from, double to, double end) {
    double size = dice_between(d, 0.6, 1.1);
    from = fmax(from, to - BREATH_LONGEST);
    double length = to - from - BREATH_AFTER - BREATH_BEFORE;
    if (to - from < BREATH_PAUSE)
        return;
    struct gesture_curve *g = add(out, end, from + BREATH_AFTER, 0.55 * length, 0, 0.45 * length);
    if (!g)
        return;
    /* short movements must be small, or they look like twitches */
    size *= fmin(1, length / 0.35);
    g->amount[GESTURE_LIPS] = (float)(BREATH_LIPS * size);
    g->amount[GESTURE_NOSTRILS] = (float)(BREATH_NOSTRILS * size);
    g->amount[GESTURE_PITCH] = (float)(BREATH_PITCH * size);
}

static void ask(struct gesture_curves *out, struct dice *d, const struct phrase *last, double end) {
    double from = fmax(last->from, last->to - 1), to = fmin(last->to, end - 0.45);
    double rise = fmin(0.5, (to - from) / 2), side = dice_roll(d) < 0.5 ? -1 : 1;
    struct gesture_curve *g = rise > 0.2 ? add(out, end, from, rise, to - from - rise, 0.45) : NULL;
    if (!g)
        return;
    g->amount[GESTURE_ROLL] = (float)(side * QUESTION_ROLL * dice_between(d, 0.8, 1.2));
    g->amount[GESTURE_PITCH] = -1;
    raise_brows(g, d, QUESTION_BROW);
}

static int by_time(const void *a, const void *b) {
    double x = ((const struct gesture_curve *)a)->at, y = ((const struct gesture_curve *)b)->at;
    return x < y ? -1 : x > y;
}

static void in_order(struct gesture_curves *curves) {
    if (curves->count)
        qsort(curves->items, curves->count, sizeof *curves->items, by_time);
}

void life_gestures_of(const struct prosody *p, uint64_t seed, struct life_gestures *out) {
    struct dice d = dice_of(seed, DICE_GESTURES, p->name);
    *out = (struct life_gestures){0};
    for (size_t i = 0; i < p->phrase_count; i++) {
        const struct phrase *phrase = &p->phrases[i];
        double next = i + 1 < p->phrase_count ? phrase[1].from : phrase->to;
        breathe(&out->quick, &d, i ? phrase[-1].to : 0, phrase->from, p->end);
        keep_turned(&out->slow, &d, phrase->from, fmin(next, p->end - PHRASE_FALL), p->end);
        for (size_t k = phrase->first; k < phrase->first + phrase->count; k++) {
            /* own random numbers, so that accents do not affect each other */
            struct dice own = dice_of(seed, DICE_NODS, p->name + (int64_t)k);
            nod(&out->quick, &p->accents[k], &own, p->end);
        }
    }
    if (p->phrase_count && p->rise > QUESTION_RISE)
        ask(&out->slow, &d, &p->phrases[p->phrase_count - 1], p->end);
    in_order(&out->quick);
    in_order(&out->slow);
}

double gesture_curve_at(const struct gesture_curve *g, double t) {
    double since = t - g->at, rise = (double)g->rise, fall = since - rise - (double)g->hold;
    return life_smooth(since < rise ? since / rise : fall < 0 ? 1 : 1 - fall / (double)g->fall);
}

static void add_at(struct gesture_curves *curves, double t, float out[GESTURE_CHANNELS]) {
    size_t i = curves->cursor;
    while (i && curves->items[i - 1].at > t - curves->longest)
        i--;
    while (i < curves->count && curves->items[i].at <= t - curves->longest)
        i++;
    curves->cursor = i;
    for (; i < curves->count && curves->items[i].at < t; i++) {
        const struct gesture_curve *g = &curves->items[i];
        float shape = (float)gesture_curve_at(g, t);
        if (shape <= 0)
            continue;
        for (int c = 0; c < GESTURE_CHANNELS; c++)
            out[c] += shape * g->amount[c];
    }
}

void life_gestures_at(struct life_gestures *gestures, double t, float out[GESTURE_CHANNELS]) {
    for (int c = 0; c < GESTURE_CHANNELS; c++)
        out[c] = 0;
    add_at(&gestures->quick, t, out);
    add_at(&gestures->slow, t, out);
}
