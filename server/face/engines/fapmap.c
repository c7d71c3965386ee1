/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/fapmap.h"
#include "server/base/mem.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/packs/shape_table.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Opening half-way to the corner relative to the middle: a parabola gives 3/4, but the lower lip is a
 * little fuller; a narrow mouth is round, so its sides close earlier. */
#define SIDE_OPENING 0.8
#define SIDE_PER_MM 0.03
#define SIDE_MIN 0.55

/* Secondary motion, mm per mm. */
#define CORNER_PER_JAW (-0.12) /* corners sink with the jaw */
#define CORNER_PER_SPREAD 0.12 /* and rise a little as they spread */
#define CHIN_PER_PRESS 0.5     /* the chin muscle lifts a pressing lower lip */
#define CHIN_PER_PUSH 0.2      /* and a protruding one */
#define CHEEK_PER_JAW (-0.06)  /* cheeks hollow as the jaw sinks */
#define CHEEK_PER_PUSH (-0.15) /* and as the lips protrude */
#define CHEEK_PER_PRESS 0.2    /* air is held behind closed lips */
#define LIFT_PER_SPREAD 0.12   /* spreading lifts the cheeks */
#define OUTER_PER_INNER 0.85   /* the outer contour moves less than the inner one */

/* Share of the jaw's movement that carries the tongue's tip and body, and how far they can sink into the
 * floor of the mouth, mm. */
#define TIP_PER_JAW 0.8
#define BODY_PER_JAW 0.5
#define TIP_FLOOR (-1.0)
#define BODY_FLOOR (-2.0)

/* Pressed lips become thin: approach of the outer contours, mm per mm of press. */
#define THIN_PER_PRESS 5.0

/* The lower lip's share in closing the lips. */
#define LOWER_SHARE 0.7

enum { MIDDLE, LEFT, RIGHT, PAIRS };

/* Opposite FAPs of the lips. Upper ones are positive downwards, lower ones upwards: they touch where the
 * sum is 0 and press where it is positive. */
static const struct {
    int upper, lower, upper_outer, lower_outer;
} pairs[PAIRS] = {{4, 5, 51, 52}, {8, 10, 55, 57}, {9, 11, 56, 58}};

static double positive(double x) {
    return x > 0 ? x : 0;
}

void fapmap_add(const struct speech_fapu *fapu, const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns, mw = 1024 / fapu->mw, es = 1024 / fapu->es, ens = 1024 / fapu->ens;
    double spread = mm[PARAM_AR] / 2; /* per corner */
    double press = positive(-mm[PARAM_LI]), push = positive((mm[PARAM_PI] + mm[PARAM_PS]) / 2),
           jaw = positive(mm[PARAM_EM]);
    double corner = CORNER_PER_JAW * jaw + CORNER_PER_SPREAD * spread;
    double side = fmax(SIDE_MIN, SIDE_OPENING + SIDE_PER_MM * fmin(0, mm[PARAM_AR]));
    for (int i = 0; i < PAIRS; i++) {
        double part = i == MIDDLE ? 1 : side, at_corner = i == MIDDLE ? 0 : (1 - side) * corner;
        double up = (part * mm[PARAM_LS] + at_corner) * mns, down = (part * mm[PARAM_LI] - at_corner) * mns;
        faps[pairs[i].upper] -= up;
        faps[pairs[i].lower] -= down;
        /* Opening thins the lips; closing is handled by fapmap_part_lips. */
        faps[pairs[i].upper_outer] -= up > 0 ? OUTER_PER_INNER * up : up;
        faps[pairs[i].lower_outer] -= down > 0 ? OUTER_PER_INNER * down : down;
    }
    faps[3] += jaw * mns;
    faps[6] += spread * mw;
    faps[7] += spread * mw;
    faps[53] += spread * mw;
    faps[54] += spread * mw;
    faps[12] += corner * mns;
    faps[13] += corner * mns;
    faps[59] += corner * mns;
    faps[60] += corner * mns;
    faps[44] += fmax(mm[PARAM_TH] + TIP_PER_JAW * jaw, TIP_FLOOR) * mns;
    faps[45] += mm[PARAM_TA] * mw;
    faps[46] += fmax(mm[PARAM_TB] + BODY_PER_JAW * jaw, BODY_FLOOR) * mns;
    faps[16] += mm[PARAM_PI] * mns;
    faps[17] += mm[PARAM_PS] * mns;
    faps[18] += (CHIN_PER_PRESS * press + CHIN_PER_PUSH * push) * mns;
    double puff = CHEEK_PER_JAW * jaw + CHEEK_PER_PUSH * push + CHEEK_PER_PRESS * press;
    faps[39] += puff * es;
    faps[40] += puff * es;
    faps[41] += LIFT_PER_SPREAD * positive(spread) * ens;
    faps[42] += LIFT_PER_SPREAD * positive(spread) * ens;
}

void fapmap_open(const struct speech_fapu *fapu, double gap, double weight, double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns;
    for (int i = 0; i < PAIRS; i++) {
        double wanted = gap * mns * (i == MIDDLE ? 1 : SIDE_OPENING);
        double move = weight * positive(wanted + faps[pairs[i].upper] + faps[pairs[i].lower]);
        faps[pairs[i].lower] -= LOWER_SHARE * move;
        faps[pairs[i].lower_outer] -= LOWER_SHARE * move;
        faps[pairs[i].upper] -= (1 - LOWER_SHARE) * move;
        faps[pairs[i].upper_outer] -= (1 - LOWER_SHARE) * move;
    }
}

static void close_lips(const struct contact_demand *d, double mns, double faps[FAP_COUNT + 1]) {
    for (int i = 0; i < PAIRS; i++) {
        double missing = d->rule->press * mns - (faps[pairs[i].upper] + faps[pairs[i].lower]);
        double move = d->weight * positive(missing);
        double thin = d->weight * THIN_PER_PRESS * d->rule->press * mns;
        faps[pairs[i].lower] += LOWER_SHARE * move;
        faps[pairs[i].lower_outer] += LOWER_SHARE * (move + thin);
        faps[pairs[i].upper] += (1 - LOWER_SHARE) * move;
        faps[pairs[i].upper_outer] += (1 - LOWER_SHARE) * (move + thin);
    }
}

static void meet_teeth(const struct contact_demand *d, double mns, double faps[FAP_COUNT + 1]) {
    double side = SIDE_OPENING;
    for (int i = 0; i < PAIRS; i++) {
        double lowest = -d->rule->reach * mns * (i == MIDDLE ? 1 : side);
        double move = d->weight * positive(lowest - faps[pairs[i].lower]);
        faps[pairs[i].lower] += move;
        faps[pairs[i].lower_outer] += move;
    }
    faps[16] -= d->weight * positive(faps[16] + d->rule->retract * mns);
}

void fapmap_touch(const struct speech_fapu *fapu, const struct contact_demand demand[CONTACT_TEETH + 1],
                  double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns;
    if (demand[CONTACT_TEETH].weight > 0)
        meet_teeth(&demand[CONTACT_TEETH], mns, faps);
    if (demand[CONTACT_LIPS].weight > 0)
        close_lips(&demand[CONTACT_LIPS], mns, faps);
}

void fapmap_part_lips(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1]) {
    double limit = FAPMAP_MAX_PRESS * 1024 / fapu->mns;
    for (int i = 0; i < PAIRS; i++) {
        double excess = positive(faps[pairs[i].upper] + faps[pairs[i].lower] - limit);
        faps[pairs[i].upper] -= excess / 2;
        faps[pairs[i].lower] -= excess / 2;
    }
}

void fapmap_read(const struct speech_fapu *fapu, const struct fap_frame *frame, double mm[PARAM_COUNT]) {
    double mns = fapu->mns / 1024, mw = fapu->mw / 1024;
    const int32_t *v = frame->value;
    double jaw = v[3] * mns;
    mm[PARAM_LS] = -v[4] * mns;
    mm[PARAM_LI] = -v[5] * mns;
    mm[PARAM_AR] = (v[6] + v[7]) * mw;
    mm[PARAM_PI] = v[16] * mns;
    mm[PARAM_PS] = v[17] * mns;
    mm[PARAM_EM] = jaw;
    mm[PARAM_TH] = v[44] * mns - TIP_PER_JAW * jaw;
    mm[PARAM_TA] = v[45] * mw;
    mm[PARAM_TB] = v[46] * mns - BODY_PER_JAW * jaw;
}

double morph_weight(enum morph_ease ease, double t) {
    return ease == MORPH_SMOOTH ? t * t * (3 - 2 * t) : t;
}

void morph_add(struct morph *morph, double at, const double *faps) {
    if (morph->count && at <= morph->keys[morph->count - 1].at)
        return;
    morph->keys = mem_grow(morph->keys, &morph->cap, morph->count + 1, sizeof *morph->keys);
    morph->keys[morph->count++] = (struct morph_key){at, faps};
}

static size_t seek(const struct morph *morph, double t, size_t next) {
    if (next && morph->keys[next - 1].at > t)
        next = 0;
    /* Steps linearly first, then by bisection. */
    for (int step = 0; step < 4; step++) {
        if (next == morph->count || morph->keys[next].at > t)
            return next;
        next++;
    }
    size_t high = morph->count;
    while (next < high) {
        size_t mid = (next + high) / 2;
        if (morph->keys[mid].at > t)
            high = mid;
        else
            next = mid + 1;
    }
    return next;
}

/* cursor->at[0]: the first key later than the last instant */
static void add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct morph *m = self;
    if (!m->count)
        return;
    size_t next = cursor->at[0] = seek(m, t, cursor->at[0]);
    const struct morph_key *to = &m->keys[next < m->count ? next : m->count - 1],
                           *from = next ? &m->keys[next - 1] : to;
    double weight = to == from ? 0 : morph_weight(m->ease, (t - from->at) / (to->at - from->at));
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] += from->faps[n] + weight * (to->faps[n] - from->faps[n]);
}

static void morphing_free(void *self) {
    struct morph *m = self;
    free(m->keys);
    free(m);
}

struct speech_layer morph_layer(struct morph *morph) {
    struct morph *m = mem_alloc(sizeof *m);
    *m = *morph;
    *morph = (struct morph){0};
    return (struct speech_layer){add, morphing_free, m};
}

/* The lids meet after IRISD in total: 1024 FAP units. */
#define LIDS_MEET 1024

static const struct speech_fapu fapu_of_models = {.irisd = 11.7, .es = 62, .ens = 42, .mns = 21, .mw = 50};
const struct speech_fapu *const face_idle_fapu = &fapu_of_models;

static void part_lids(double faps[FAP_COUNT + 1]) {
    for (int upper = 19; upper <= 20; upper++)
        faps[upper] -= fmax(0, faps[upper] + faps[upper + 2] - LIDS_MEET);
}

void face_limits_apply(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1], struct fap_frame *frame) {
    fapmap_part_lips(fapu, faps);
    part_lids(faps);
    for (int n = 3; n <= FAP_COUNT; n++) {
        frame->value[n] = 0;
        if (faps[n] == 0) /* common, and always within limits */
            continue;
        double value = faps[n] < fap_table[n].min   ? fap_table[n].min
                       : faps[n] > fap_table[n].max ? fap_table[n].max
                                                    : faps[n];
        frame->value[n] = (int32_t)(value + (value < 0 ? -0.5 : 0.5));
    }
    frame->mask[0] |= 0xfc; /* FAPs 3 to 8 */
    memset(frame->mask + 1, 0xff, FAP_MASK_BYTES - 2);
    frame->mask[FAP_MASK_BYTES - 1] |= 0x0f; /* 65 to 68 */
}
