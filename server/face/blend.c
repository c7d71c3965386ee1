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

enum part { PART_FREE, PART_LIPS, PART_CORNERS, PART_TONGUE };

static const uint8_t lips[] = {3, 4, 5, 8, 9, 10, 11, 14, 15, 16, 17, 18, 51, 52, 55, 56, 57, 58},
                     heights[] = {12, 13, 59, 60}, widths[] = {6, 7, 53, 54};

/* clang-format off */
static const uint8_t part_of[FAP_COUNT + 1] = {
    [3] = PART_LIPS, PART_LIPS, PART_LIPS, PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [12] = PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [43] = PART_TONGUE, PART_TONGUE, PART_TONGUE, PART_TONGUE, PART_TONGUE,
    [51] = PART_LIPS, PART_LIPS, PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [59] = PART_CORNERS, PART_CORNERS,
};
/* clang-format on */

void blend_add(struct blend *b, const struct pose *pose, double w, struct mouth_share mouth) {
    const double kept[] = {[PART_FREE] = w,
                           [PART_LIPS] = w * (1 - b->activity * (1 - mouth.lips)),
                           [PART_CORNERS] = w * (1 - b->activity * (1 - mouth.corners)),
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
    return value > max ? max : value < -max ? -max : value;
}

/* What stays within bounds while she speaks and is free in pauses. */
static void hold(struct blend *b, const uint8_t *faps, size_t count, double max, double share) {
    for (size_t i = 0; i < count; i++) {
        double value = b->faps[faps[i]];
        b->faps[faps[i]] = share * (value + b->activity * (limit(value, max) - value));
    }
}

static double smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

static void hold_mouth(struct blend *b, const double faps[FAP_COUNT + 1]) {
    /* Where the mouth has to be closed, or the lip at the teeth, speech has it alone. */
    hold(b, lips, sizeof lips, LIPS_MAX, 1 - b->contact);
    hold(b, heights, sizeof heights, CORNER_HEIGHT_MAX, 1);
    bool pulls = b->faps[6] + b->faps[7] > 0;
    double round = smooth(-(faps[6] + faps[7]) / (2 * ROUND));
    hold(b, widths, sizeof widths, CORNER_WIDTH_MAX, pulls ? 1 - ROUND_SHARE * round : 1);
}

/* Eq. 5.3 and 5.4 as displacements: (1 - omega) speech + omega rho emotion. The published rule lets lips open
 * in closures; here it gives way to them. */
static void hold_speech(struct blend *b, double faps[FAP_COUNT + 1]) {
    double omega = b->omega < 1 ? b->omega : 1, free = 1 - b->contact;
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] *= 1 - omega * (part_of[n] == PART_LIPS || part_of[n] == PART_TONGUE ? free : 1);
    for (size_t i = 0; i < sizeof lips; i++)
        b->faps[lips[i]] *= free;
}

static void articulate(double factor, double faps[FAP_COUNT + 1]) {
    if (factor == 1)
        return;
    factor = factor < ARTICULATION_MIN ? ARTICULATION_MIN : limit(factor, ARTICULATION_MAX);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (part_of[n] != PART_TONGUE)
            faps[n] *= factor;
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
    articulate(b->articulation, faps);
    if (b->rule == BLEND_WEIGHTED)
        hold_speech(b, faps);
    else
        hold_mouth(b, faps);
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] += b->faps[n];
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
