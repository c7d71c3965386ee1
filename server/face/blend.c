/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/blend.h"
#include <math.h>

/* Empowering constant of eq. 5.2. Weights above 1/3 would show more than the whole expression: that much is
 * let through, no more. */
#define RHO 3
#define SHOWN_MAX 1.25

/* Speech moves by so much less or more at most, whatever is asked. */
#define ARTICULATION_MIN 0.75
#define ARTICULATION_MAX 1.3

/* Regions: while she speaks, an expression may add no more than this, FAP units: lips and jaw (1.5 mm of the
 * modelled speaker), corners up and down, and sideways. */
#define LIPS_MAX 75
#define CORNER_HEIGHT_MAX 190
#define CORNER_WIDTH_MAX 80
/* Rounded lips are not pulled apart: of what an expression adds to the width at most so much is taken away,
 * in full when the corners have come in by ROUND. */
#define ROUND_SHARE 0.8
#define ROUND 100

#define INTENSITY_MAX 63 /* of FAP 2 */

enum part { PART_FREE, PART_LIPS, PART_CORNER_HEIGHT, PART_CORNER_WIDTH, PART_TONGUE };

static const uint8_t part_of[FAP_COUNT + 1] = {
    [3] = PART_LIPS,          [4] = PART_LIPS,           [5] = PART_LIPS,           [6] = PART_CORNER_WIDTH,
    [7] = PART_CORNER_WIDTH,  [8] = PART_LIPS,           [9] = PART_LIPS,           [10] = PART_LIPS,
    [11] = PART_LIPS,         [12] = PART_CORNER_HEIGHT, [13] = PART_CORNER_HEIGHT, [14] = PART_LIPS,
    [15] = PART_LIPS,         [16] = PART_LIPS,          [17] = PART_LIPS,          [18] = PART_LIPS,
    [43] = PART_TONGUE,       [44] = PART_TONGUE,        [45] = PART_TONGUE,        [46] = PART_TONGUE,
    [47] = PART_TONGUE,       [51] = PART_LIPS,          [52] = PART_LIPS,          [53] = PART_CORNER_WIDTH,
    [54] = PART_CORNER_WIDTH, [55] = PART_LIPS,          [56] = PART_LIPS,          [57] = PART_LIPS,
    [58] = PART_LIPS,         [59] = PART_CORNER_HEIGHT, [60] = PART_CORNER_HEIGHT};

void blend_add(struct blend *b, const struct pose *pose, double w, struct mouth_share mouth) {
    const double kept[] = {[PART_FREE] = w,
                           [PART_LIPS] = w * (1 - b->activity * (1 - mouth.lips)),
                           [PART_CORNER_HEIGHT] = w * (1 - b->activity * (1 - mouth.corners)),
                           [PART_CORNER_WIDTH] = w * (1 - b->activity * (1 - mouth.corners)),
                           [PART_TONGUE] = w * (1 - b->activity)};
    for (size_t i = 0; i < pose->count; i++)
        b->faps[pose->faps[i].fap] += kept[part_of[pose->faps[i].fap]] * pose->faps[i].value;
}

double blend_shown(double omega) {
    return fmin(RHO * omega, SHOWN_MAX);
}

void blend_add_weighted(struct blend *b, const struct pose *pose, double omega) {
    double shown = blend_shown(omega);
    b->omega += omega;
    for (size_t i = 0; i < pose->count; i++)
        b->faps[pose->faps[i].fap] += shown * pose->faps[i].value;
}

static double limit(double value, double max) {
    return fmin(max, fmax(-max, value));
}

/* What stays within bounds while she speaks and is free in pauses. */
static double offset(const struct blend *b, int n, double max) {
    double inside = limit(b->faps[n], max);
    return b->faps[n] + b->activity * (inside - b->faps[n]);
}

static double smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

static void join_regions(const struct blend *b, double faps[FAP_COUNT + 1]) {
    /* Where the mouth has to be closed, or the lip at the teeth, speech has it alone. */
    double free = 1 - b->contact, round = 1 - ROUND_SHARE * smooth(-(faps[6] + faps[7]) / (2 * ROUND));
    for (int n = 3; n <= FAP_COUNT; n++) {
        switch (part_of[n]) {
        case PART_LIPS:
            faps[n] += free * offset(b, n, LIPS_MAX);
            break;
        case PART_CORNER_HEIGHT:
            faps[n] += offset(b, n, CORNER_HEIGHT_MAX);
            break;
        case PART_CORNER_WIDTH:
            faps[n] += (b->faps[n] > 0 ? round : 1) * offset(b, n, CORNER_WIDTH_MAX);
            break;
        default:
            faps[n] += b->faps[n];
        }
    }
}

/* Eq. 5.3 and 5.4 as displacements: (1 - omega) speech + omega rho emotion. The published rule lets lips open
 * in closures; here it gives way to them. */
static void join_weighted(const struct blend *b, double faps[FAP_COUNT + 1]) {
    double omega = fmin(1, b->omega), free = 1 - b->contact;
    for (int n = 3; n <= FAP_COUNT; n++) {
        bool is_bound = part_of[n] == PART_LIPS || part_of[n] == PART_TONGUE;
        faps[n] *= 1 - omega * (is_bound ? free : 1);
        faps[n] += (is_bound ? free : 1) * b->faps[n];
    }
}

/* The recipes say where she looks; the eyes in the head make up for what the head does. */
static void hold_gaze(double faps[FAP_COUNT + 1]) {
    faps[23] -= faps[49];
    faps[24] -= faps[49];
    faps[25] -= faps[48];
    faps[26] -= faps[48];
}

void blend_join(struct blend *b, double faps[FAP_COUNT + 1]) {
    hold_gaze(b->faps);
    double articulation = limit(b->articulation, ARTICULATION_MAX);
    articulation = fmax(ARTICULATION_MIN, articulation);
    if (articulation != 1)
        for (int n = 3; n <= FAP_COUNT; n++)
            if (part_of[n] != PART_TONGUE)
                faps[n] *= articulation;
    if (b->rule == BLEND_WEIGHTED)
        join_weighted(b, faps);
    else
        join_regions(b, faps);
}

struct fap_expression blend_basics(const double shares[BASIC_COUNT + 1]) {
    int first = 0, second = 0;
    for (int b = 1; b <= BASIC_COUNT; b++) {
        if (shares[b] > (first ? shares[first] : 0)) {
            second = first;
            first = b;
        } else if (shares[b] > (second ? shares[second] : 0)) {
            second = b;
        }
    }
    struct fap_expression out = {0};
    if (first)
        out.intensity1 = (uint8_t)lround(INTENSITY_MAX * fmin(1, shares[first]));
    if (second)
        out.intensity2 = (uint8_t)lround(INTENSITY_MAX * fmin(1, shares[second]));
    out.select1 = out.intensity1 ? (uint8_t)first : 0;
    out.select2 = out.intensity2 ? (uint8_t)second : 0;
    return out;
}
