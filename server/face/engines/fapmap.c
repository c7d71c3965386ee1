/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/fapmap.h"
#include "server/base/mem.h"
#include "server/base/smoothstep.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/packs/shape_table.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Opening half-way to the corner relative to the middle: a parabola gives 3/4, but the lower lip is a
 * little fuller. */
#define SIDE_OPENING 0.8

/* Rounded lips protrude and touch each other from the corners inwards, leaving a hole of about a third of
 * their width open, while the corners move only 2 or 3 mm. Rounding grows with narrowing and protrusion, and
 * needs parted teeth. With a raised upper lip (/S/) the lips form a funnel instead, whose square opening
 * shows the teeth: it is short, but as high at the sides as in the middle. */
#define ROUND_NARROW 1.7       /* mm of AR, and */
#define ROUND_PUSH 1.2         /* mm of protrusion at which lips are fully rounded */
#define FLARE_FROM 1.7         /* mm of LS at which a funnel starts */
#define FLARE_FULL 2.3         /* and is complete */
#define TEETH_MET 1.0          /* mm of EM at which rounding starts, because it needs parted teeth, */
#define TEETH_APART 2.5        /* and at which it is complete */
#define ROUND_SHARE 0.72       /* the sides open less by this share of the opening */
#define ROUND_INNER_CORNER 3.0 /* mm that each inner corner goes in beyond the outer one */
/* mm that the middle of the lower lip gives way: pushed lips roll into the opening */
#define ROUND_DROP 1.5
/* Both lips lie so that the hole is over the gap between the teeth, mm that they hang lower: */
#define ROUND_LOW_PER_JAW 0.5 /* for each mm of the jaw */
#define ROUND_LOW_FROM 4.5    /* beyond these, */
#define ROUND_LOW_MOST 0.9    /* at most, either way; */
#define ROUND_LOW_SIDE 1.1    /* and that more half-way to the corners, under which the hole is arched */
#define ROUND_BULGE 0.7       /* mm that the red of each lip becomes wider */
#define FUNNEL_NARROW 1.2     /* mm of AR at which lips that are not rounded form a full funnel */
#define FUNNEL_CORNER 5.0     /* mm that each inner corner goes in beyond the outer one */
#define FUNNEL_SIDE 1.15      /* factor on the opening half-way to the corners */
#define FUNNEL_LIFT 0.9       /* mm that the upper lip turns up, */
#define FUNNEL_DROP 0.5       /* and the lower lip down, */
#define FUNNEL_OPEN 3.0       /* from an opening of these mm on wholly */
#define FUNNEL_BULGE 0.8      /* mm that the red of each becomes wider */

/* Secondary motion, mm per mm. */
#define CORNER_PER_JAW (-0.12) /* corners sink with the jaw */
#define CORNER_PER_SPREAD 0.12 /* and rise a little as they spread */
#define CHIN_PER_PRESS 0.5     /* the chin muscle lifts a pressing lower lip */
#define CHIN_PER_PUSH 0.2      /* and a protruding one */
#define CHEEK_PER_JAW (-0.06)  /* cheeks hollow as the jaw sinks */
#define CHEEK_PER_PUSH (-0.15) /* and as the lips protrude */
#define CHEEK_PER_PRESS 0.2    /* air is held behind closed lips */
#define LIFT_PER_SPREAD 0.12   /* spreading lifts the cheeks */
#define OUTER_PER_INNER 0.75   /* an opening lip becomes thinner: its outer contour moves less */
#define THIN_PER_SPREAD 0.12   /* and so does a lip that is drawn wide, mm per mm of width */
#define LOW_PER_SPREAD 0.25    /* a slit between spread lips lies lower, so that the lower teeth show, too, */
#define LOW_FROM 3.0           /* from an opening of these mm on wholly */

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

/* A lower lip at the upper teeth is rolled in: mm that its outer contour rises, per mm that the lip lies
 * back. The upper lip uncovers the teeth by this, mm. */
#define ROLL_PER_RETRACT 1.2
#define UPPER_AT_TEETH 1.2
#define CHIN_PER_RETRACT 0.3

enum { MIDDLE, LEFT, RIGHT, PAIRS };

/* Opposite FAPs of the lips. Upper ones are positive downwards, lower ones upwards: they touch where the
 * sum is 0 and press where it is positive. */
static const struct {
    int upper, lower, upper_outer, lower_outer;
} pairs[PAIRS] = {{4, 5, 51, 52}, {8, 10, 55, 57}, {9, 11, 56, 58}};

static double positive(double x) {
    return x > 0 ? x : 0;
}

/* How far the lips are a round hole, and how far a funnel, 0 to 1. */
struct pursing {
    double round, funnel;
};

static double pursed(double narrow, double width, double push) {
    return smoothstep(-width / narrow) * smoothstep(push / ROUND_PUSH);
}

/* flare: 0 to 1, how far the upper lip is raised. */
static struct pursing pursing(double width, double push, double jaw, double flare) {
    double apart = smoothstep((jaw - TEETH_MET) / (TEETH_APART - TEETH_MET));
    flare *= 1 - apart;
    return (struct pursing){pursed(ROUND_NARROW, width, push) * apart * (1 - flare),
                            pursed(FUNNEL_NARROW, width, push) * flare};
}

static struct pursing pursing_from(const double mm[PARAM_COUNT]) {
    return pursing(mm[PARAM_AR], (mm[PARAM_PI] + mm[PARAM_PS]) / 2, mm[PARAM_EM],
                   1 - smoothstep((FLARE_FULL - mm[PARAM_LS]) / (FLARE_FULL - FLARE_FROM)));
}

/* mm that each inner corner goes in beyond the outer one. */
static double inset(struct pursing p) {
    return ROUND_INNER_CORNER * p.round + FUNNEL_CORNER * p.funnel;
}

/* The same of a face: its inner corners tell whether the upper lip is raised. */
static struct pursing pursing_of(const struct speech_fapu *fapu, const double faps[FAP_COUNT + 1]) {
    double mns = fapu->mns / 1024, mw = fapu->mw / 1024;
    double width = (faps[53] + faps[54]) * mw, push = (faps[16] + faps[17]) / 2 * mns;
    double in = fmin(fmax(width / 2 - (faps[6] + faps[7]) / 2 * mw, 0), FUNNEL_CORNER);
    double round = inset(pursing(width, push, faps[3] * mns, 0)),
           funnel = inset(pursing(width, push, faps[3] * mns, 1));
    struct pursing p = pursing(width, push, faps[3] * mns,
                               funnel - round > 0.1 ? fmin(fmax((in - round) / (funnel - round), 0), 1) : 0);
    /* Poses between others, and other layers, may be less narrow or pushed than their inner corners are: they
     * count as rounded. */
    p.round = fmin(p.round + fmax(in - inset(p), 0) / ROUND_INNER_CORNER, 1);
    return p;
}

/* Returns how far both lips are lowered beyond their parameters, mm. */
static double lowered(int pair, double width, double open, double jaw, double round) {
    double low = ROUND_LOW_PER_JAW * (jaw - ROUND_LOW_FROM);
    return (fmin(fmax(low, -ROUND_LOW_MOST), ROUND_LOW_MOST) + (pair == MIDDLE ? 0 : ROUND_LOW_SIDE)) *
               round +
           LOW_PER_SPREAD * positive(width) * smoothstep(open / LOW_FROM);
}

/* Opening half-way to the corner for one in the middle, mm. */
static double side_opening(double middle, struct pursing p) {
    double side = SIDE_OPENING * middle * (1 + (FUNNEL_SIDE - 1) * p.funnel);
    return side > 0 ? (1 - ROUND_SHARE * p.round) * side : side;
}

void fapmap_add(const struct speech_fapu *fapu, const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns, mw = 1024 / fapu->mw, es = 1024 / fapu->es, ens = 1024 / fapu->ens;
    double spread = mm[PARAM_AR] / 2; /* per corner */
    double press = positive(-mm[PARAM_LI]), push = positive((mm[PARAM_PI] + mm[PARAM_PS]) / 2),
           jaw = positive(mm[PARAM_EM]), open = mm[PARAM_LI] + mm[PARAM_LS];
    struct pursing purse = pursing_from(mm);
    double round = purse.round, turned = purse.funnel * fmin(positive(open) / FUNNEL_OPEN, 1);
    double corner = CORNER_PER_JAW * jaw + CORNER_PER_SPREAD * spread;
    double side = open > 0 ? side_opening(open, purse) / open : SIDE_OPENING;
    double wider =
        ROUND_BULGE * round + FUNNEL_BULGE * purse.funnel - THIN_PER_SPREAD * positive(mm[PARAM_AR]);
    for (int i = 0; i < PAIRS; i++) {
        double part = i == MIDDLE ? 1 : side, at_corner = i == MIDDLE ? 0 : (1 - side) * corner;
        double up = part * mm[PARAM_LS] + at_corner, down = part * mm[PARAM_LI] - at_corner;
        double low = lowered(i, mm[PARAM_AR], open, jaw, round), drop = i == MIDDLE ? ROUND_DROP * round : 0;
        faps[pairs[i].upper] -= (up - low + FUNNEL_LIFT * turned) * mns;
        faps[pairs[i].lower] -= (down + low + drop + FUNNEL_DROP * turned) * mns;
        /* Opening thins the lips; closing is handled by fapmap_part_lips. */
        faps[pairs[i].upper_outer] -= ((up > 0 ? OUTER_PER_INNER * up : up) + wider) * mns;
        faps[pairs[i].lower_outer] -= ((down > 0 ? OUTER_PER_INNER * down : down) + wider) * mns;
    }
    faps[3] += jaw * mns;
    faps[6] += (spread - inset(purse)) * mw;
    faps[7] += (spread - inset(purse)) * mw;
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
    struct pursing purse = pursing_of(fapu, faps);
    for (int i = 0; i < PAIRS; i++) {
        double wanted = (i == MIDDLE ? gap : side_opening(gap, purse)) * mns;
        if (wanted <= 0) /* rounded lips meet here */
            continue;
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
    double retract = d->rule->retract * mns;
    for (int i = 0; i < PAIRS; i++) {
        double part = d->weight * (i == MIDDLE ? 1 : SIDE_OPENING) * mns;
        double lift = -d->rule->reach * part - d->weight * faps[pairs[i].lower];
        double drop = -UPPER_AT_TEETH * part - d->weight * faps[pairs[i].upper];
        faps[pairs[i].lower] += lift;
        faps[pairs[i].lower_outer] += lift + d->weight * ROLL_PER_RETRACT * retract;
        faps[pairs[i].upper] += drop;
        faps[pairs[i].upper_outer] += drop;
    }
    faps[16] -= d->weight * positive(faps[16] + retract);
    faps[18] += d->weight * CHIN_PER_RETRACT * retract;
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
    double jaw = v[3] * mns, faps[FAP_COUNT + 1] = {0};
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] = v[n];
    struct pursing purse = pursing_of(fapu, faps);
    double round = purse.round;
    mm[PARAM_AR] = (v[53] + v[54]) * mw;
    double open = -(v[4] + v[5]) * mns - ROUND_DROP * round;
    double most = (FUNNEL_LIFT + FUNNEL_DROP) * purse.funnel; /* mm that turned lips open more */
    double part = fmin(positive(open) / (FUNNEL_OPEN + most), 1), turned = purse.funnel * part;
    open -= most * part;
    double low = lowered(MIDDLE, mm[PARAM_AR], open, jaw, round);
    mm[PARAM_LS] = low - v[4] * mns - FUNNEL_LIFT * turned;
    mm[PARAM_LI] = -v[5] * mns - low - ROUND_DROP * round - FUNNEL_DROP * turned;
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
