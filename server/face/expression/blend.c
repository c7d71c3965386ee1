/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/expression/blend.h"
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
                     heights[] = {12, 13, 59, 60}, widths[] = {6, 7, 53, 54}, tongue[] = {43, 44, 45, 46, 47};

/* clang-format off */
static const uint8_t part_of[FAP_COUNT + 1] = {
    [3] = PART_LIPS, PART_LIPS, PART_LIPS, PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [12] = PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [43] = PART_TONGUE, PART_TONGUE, PART_TONGUE, PART_TONGUE, PART_TONGUE,
    [51] = PART_LIPS, PART_LIPS, PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [59] = PART_CORNERS, PART_CORNERS,
};
/* clang-format on */

/* Adds w times the pose: the mouth's part to b->mouth, in shares by part, the rest to the face. */
static void add(struct blend *b, const struct pose *pose, double w, const double shares[]) {
    for (size_t i = 0; i < pose->count; i++) {
        const struct pose_fap *p = &pose->faps[i];
        enum part part = part_of[p->fap];
        if (part)
            b->mouth[p->fap] += w * shares[part] * p->value;
        else
            b->face[p->fap] += w * p->value;
    }
}

void blend_add(struct blend *b, const struct pose *pose, double w, struct mouth_share mouth) {
    const double shares[] = {[PART_LIPS] = 1 - b->activity * (1 - mouth.lips),
                             [PART_CORNERS] = 1 - b->activity * (1 - mouth.corners),
                             [PART_TONGUE] = 1 - b->activity};
    add(b, pose, w, shares);
}

double blend_shown(double omega) {
    return fmin(RHO * omega, SHOWN_MAX);
}

void blend_add_weighted(struct blend *b, const struct pose *pose, double omega) {
    static const double whole[] = {1, 1, 1, 1};
    add(b, pose, blend_shown(omega), whole);
}

static double limit(double value, double max) {
    return value > max ? max : value < -max ? -max : value;
}

static double smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

/* (1 - omega) speech. The published rule lets lips open in closures; here it gives way to them. */
static void weaken(const struct blend *b, double omega) {
    double lips_left = 1 - omega * (1 - b->contact);
    for (int n = 3; n <= FAP_COUNT; n++)
        b->face[n] *= part_of[n] == PART_LIPS || part_of[n] == PART_TONGUE ? lips_left : 1 - omega;
}

void blend_speech(const struct blend *b, double articulation, double omega) {
    articulation = articulation < ARTICULATION_MIN ? ARTICULATION_MIN : limit(articulation, ARTICULATION_MAX);
    if (articulation != 1)
        for (int n = 3; n <= FAP_COUNT; n++)
            if (part_of[n] != PART_TONGUE)
                b->face[n] *= articulation;
    if (omega > 0)
        weaken(b, limit(omega, 1));
}

/* Adds FAPs of the mouth: what stays within max while she speaks and is free in pauses. */
static void join(const struct blend *b, const uint8_t *faps, size_t count, double max, double share) {
    for (size_t i = 0; i < count; i++) {
        double value = b->mouth[faps[i]];
        b->face[faps[i]] += share * (value + b->activity * (limit(value, max) - value));
    }
}

void blend_join(const struct blend *b) {
    /* Where the mouth has to be closed, or the lip at the teeth, speech has it alone. */
    double free = 1 - b->contact, width = 1;
    bool bounded = b->rule == BLEND_REGIONS;
    if (bounded && b->mouth[6] + b->mouth[7] > 0)
        width = 1 - ROUND_SHARE * smooth(-(b->face[6] + b->face[7]) / (2 * ROUND));
    join(b, lips, sizeof lips, bounded ? LIPS_MAX : INFINITY, free);
    join(b, heights, sizeof heights, bounded ? CORNER_HEIGHT_MAX : INFINITY, 1);
    join(b, widths, sizeof widths, bounded ? CORNER_WIDTH_MAX : INFINITY, width);
    join(b, tongue, sizeof tongue, INFINITY, free);
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
