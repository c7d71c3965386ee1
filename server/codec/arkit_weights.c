/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/arkit_weights.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_EACH = 10 };

/* Relative size below which a gradient counts as 0. */
#define NEGLIGIBLE 1e-11

void box_squares_begin(struct box_squares *s) {
    memset(s->x, 0, sizeof s->x);
    memset(s->at, -1, sizeof s->at);
}

static double gradient(const struct box_squares *s, const double *right, size_t i) {
    double sum = -right[i];
    for (size_t k = 0; k < s->count; k++)
        sum += s->gram[i][k] * s->x[k];
    return sum;
}

/* Solves for the free variables without bounds, by Cholesky, with the others fixed. */
static void solve_free(struct box_squares *s, const double *right, const size_t *free, size_t n,
                       double *out) {
    for (size_t i = 0; i < n; i++) {
        double rest = right[free[i]];
        for (size_t k = 0; k < s->count; k++)
            if (s->at[k] > 0)
                rest -= s->gram[free[i]][k] * s->most[k];
        for (size_t j = 0; j <= i; j++) {
            double sum = s->gram[free[i]][free[j]];
            for (size_t k = 0; k < j; k++)
                sum -= s->factor[i][k] * s->factor[j][k];
            s->factor[i][j] = i == j ? sqrt(sum) : sum / s->factor[j][j];
        }
        for (size_t k = 0; k < i; k++)
            rest -= s->factor[i][k] * out[k];
        out[i] = rest / s->factor[i][i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            out[i] -= s->factor[k][i] * out[k];
        out[i] /= s->factor[i][i];
    }
}

/* Moves towards the unconstrained solution until a bound is hit, and fixes that variable. Returns whether
 * it got there. */
static bool go(struct box_squares *s, const double *right) {
    size_t free[BOX_SQUARES_MAX] = {0}, n = 0, stop = 0;
    double wanted[BOX_SQUARES_MAX] = {0}, way = 1;
    for (size_t i = 0; i < s->count; i++)
        if (!s->at[i])
            free[n++] = i;
    solve_free(s, right, free, n, wanted);
    for (size_t i = 0; i < n; i++) {
        double from = s->x[free[i]], bound = wanted[i] < 0 ? 0 : s->most[free[i]];
        if ((wanted[i] >= 0 && wanted[i] <= bound) || wanted[i] == from)
            continue;
        double part = (bound - from) / (wanted[i] - from);
        if (part < way) {
            way = part;
            stop = i;
        }
    }
    for (size_t i = 0; i < n; i++)
        s->x[free[i]] += way * (wanted[i] - s->x[free[i]]);
    if (way == 1)
        return true;
    s->at[free[stop]] = wanted[stop] < 0 ? -1 : 1;
    s->x[free[stop]] = wanted[stop] < 0 ? 0 : s->most[free[stop]];
    return false;
}

/* Gain from releasing a fixed variable into the box; 0 or less = none. */
static double pull(const struct box_squares *s, const double *right, size_t i) {
    double weight = s->gram[i][i] * s->most[i];
    return s->at[i] ? s->at[i] * gradient(s, right, i) / weight - NEGLIGIBLE : 0;
}

size_t box_squares_solve(struct box_squares *s, const double *right) {
    size_t steps = 1, most = STEPS_EACH * s->count;
    for (;; steps++) {
        while (!go(s, right) && steps < most)
            steps++;
        size_t best = s->count;
        double strongest = 0;
        for (size_t i = 0; i < s->count; i++) {
            double here = pull(s, right, i);
            if (here > strongest) {
                strongest = here;
                best = i;
            }
        }
        if (best == s->count || steps >= most)
            return steps;
        s->at[best] = 0;
    }
}

double box_squares_violation(const struct box_squares *s, const double *right) {
    double worst = 0;
    for (size_t i = 0; i < s->count; i++) {
        double g = gradient(s, right, i) / (s->gram[i][i] * s->most[i]);
        bool low = s->x[i] <= 0, high = s->x[i] >= s->most[i];
        double here = low ? -g : high ? g : fabs(g);
        worst = fmax(worst, here);
    }
    return worst;
}

/* Ridge in mm: a shape must explain more than this, so that few of several similar shapes are used; among
 * equal solutions the smallest wins. mm^2 for weight 1, where shapes have 20 to 400. */
#define FEW 0.02
#define FEW_RARE 0.15
#define RIDGE 0.001

/* Weight of 1 mm of gap between lips or lids relative to other errors. */
#define GAP_WEIGHT 5.0

/* The same in the middle of the lips: of round lips the sides are shut and the middle is open, which few
 * shapes show together, and the middle is what is read. */
#define MIDDLE_WEIGHT 14.0

/* Up to 3 mm forward, FAP 45 leaves the tip of the tongue at the teeth. */
#define TIP_AT_TEETH 61.0

/* Smaller weights of tongueOut may be noise: the tongue is on its way to the teeth. */
#define TONGUE_OUT_LEAST 0.05

/* A blink is rounded to 1 from the value at which the lids meet. */
#define LIDS_MEET 1024.0
#define NEARLY_SHUT 0.85

enum { PAIRS = 3, LIDS = 2 };

/* Opposite FAPs of lips and lids, which touch where their sum is 0 or LIDS_MEET. */
static const int lips[PAIRS][2] = {{4, 5}, {8, 10}, {9, 11}};
static const int lids[LIDS][2] = {{19, 21}, {20, 22}};

/* Returns mm per FAP unit on the face that arkit.json is made for. The radius of an eyeball is 12 mm. */
static double length_of(int fap) {
    static const double units[] = {[FAP_UNIT_IRISD] = 11.7,
                                   [FAP_UNIT_ES] = 62,
                                   [FAP_UNIT_ENS] = 42,
                                   [FAP_UNIT_MNS] = 21,
                                   [FAP_UNIT_MW] = 50};
    return fap_table[fap].unit == FAP_UNIT_AU ? 12e-5 : units[fap_table[fap].unit] / 1024;
}

/* Weight of 1 mm. Outer contours follow inner ones and cheeks follow the mouth; FAPs that no shape moves
 * have none, nor has the tongue, whose single shape is computed apart. */
static double importance(int fap) {
    if (fap >= 51 && fap <= 60)
        return 0.3;
    if (fap == 3)
        return 0.6;
    if (fap == 18 || (fap >= 39 && fap <= 42))
        return 0.4;
    return (fap >= 43 && fap <= 50) || (fap >= 27 && fap <= 30) || fap < 3 || fap > 63 ? 0 : 1;
}

/* Two unknowns are not weights: jawOpen is replaced by the jaw opening with open lips, and mouthClose by
 * that with closed lips, which ensures mouthClose <= jawOpen. */
struct arkit_solver {
    struct box_squares squares;
    double columns[ARKIT_SHAPES][FAP_COUNT + 1]; /* effect of an unknown, FAP units */
    double right[ARKIT_SHAPES][FAP_COUNT + 1];   /* A'b per FAP of a frame */
};

/* Applies the metric's row for a FAP to a column. */
static double weigh(const double *column, int fap) {
    double size = importance(fap) * length_of(fap), sum = size * size * column[fap];
    for (int i = 0; i < PAIRS + LIDS; i++) {
        const int *pair = i < PAIRS ? lips[i] : lids[i - PAIRS];
        double gap = (i ? GAP_WEIGHT : MIDDLE_WEIGHT) * length_of(pair[0]);
        if (fap == pair[0] || fap == pair[1])
            sum += gap * gap * (column[pair[0]] + column[pair[1]]);
    }
    return sum;
}

struct arkit_solver *arkit_solver_new(void) {
    struct arkit_solver *s = mem_alloc(sizeof *s);
    s->squares.count = ARKIT_SHAPES;
    for (int i = 0; i < ARKIT_SHAPES; i++) {
        s->squares.most[i] = 1;
        for (int n = 3; n <= FAP_COUNT; n++)
            s->columns[i][n] =
                arkit_table[i].faps[n] + (i == ARKIT_MOUTH_CLOSE ? arkit_table[ARKIT_JAW_OPEN].faps[n] : 0);
    }
    for (int i = 0; i < ARKIT_SHAPES; i++)
        for (int n = 3; n <= FAP_COUNT; n++)
            s->right[i][n] = weigh(s->columns[i], n);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        for (int k = 0; k < ARKIT_SHAPES; k++) {
            s->squares.gram[i][k] = i == k ? RIDGE : 0;
            for (int n = 3; n <= FAP_COUNT; n++)
                s->squares.gram[i][k] += s->right[i][n] * s->columns[k][n];
        }
    box_squares_begin(&s->squares);
    return s;
}

void arkit_solver_free(struct arkit_solver *solver) {
    free(solver);
}

static double value_of(const struct fap_frame *frame, int fap) {
    return fap_frame_has(frame, fap) ? frame->value[fap] : 0;
}

/* Gap between a pair of lips caused by one shape. */
static double opens(const int32_t *faps, int pair) {
    return -(double)(faps[lips[pair][0]] + faps[lips[pair][1]]);
}

double arkit_gap(const double weights[ARKIT_SHAPES], int pair) {
    double gap = 0;
    for (int i = 0; i < ARKIT_SHAPES; i++)
        gap += weights[i] * opens(arkit_table[i].faps, pair);
    return gap;
}

static bool touch(const struct fap_frame *frame, int pair) {
    return value_of(frame, lips[pair][0]) + value_of(frame, lips[pair][1]) >= 0;
}

/* Closes lips that touch in the frame but not with the weights: scales down all shapes that open them,
 * except the jaw. */
static void close_lips(const struct fap_frame *frame, double w[ARKIT_SHAPES]) {
    double keep = 1;
    if (!touch(frame, 0))
        return;
    for (int p = 0; p < PAIRS; p++) {
        double open = (w[ARKIT_JAW_OPEN] - w[ARKIT_MOUTH_CLOSE]) * opens(arkit_table[ARKIT_JAW_OPEN].faps, p);
        double shut = 0;
        for (int i = 0; i < ARKIT_SHAPES; i++) {
            double gap = w[i] * opens(arkit_table[i].faps, p);
            bool jaw = i == ARKIT_JAW_OPEN || i == ARKIT_MOUTH_CLOSE;
            open += !jaw && gap > 0 ? gap : 0;
            shut += !jaw && gap < 0 ? -gap : 0;
        }
        if (touch(frame, p) && open > shut)
            keep = fmin(keep, shut / open);
    }
    if (keep == 1)
        return;
    w[ARKIT_MOUTH_CLOSE] += (1 - keep) * (w[ARKIT_JAW_OPEN] - w[ARKIT_MOUTH_CLOSE]);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (i != ARKIT_JAW_OPEN && opens(arkit_table[i].faps, 0) > 0)
            w[i] *= keep;
}

static void close_lids(const struct fap_frame *frame, double w[ARKIT_SHAPES]) {
    static const int blink[LIDS] = {ARKIT_EYE_BLINK_LEFT, ARKIT_EYE_BLINK_RIGHT};
    for (int side = 0; side < LIDS; side++) {
        double shut = (value_of(frame, lids[side][0]) + value_of(frame, lids[side][1])) / LIDS_MEET;
        w[blink[side]] = fmin(1, fmax(w[blink[side]], (shut - NEARLY_SHUT) / (1 - NEARLY_SHUT)));
    }
}

void arkit_weights(struct arkit_solver *solver, const struct fap_frame *frame, double weights[ARKIT_SHAPES]) {
    double right[ARKIT_SHAPES] = {0};
    for (int n = 3; n <= FAP_COUNT; n++) {
        double value = value_of(frame, n);
        for (int i = 0; value != 0 && i < ARKIT_SHAPES; i++)
            right[i] += solver->right[i][n] * value;
    }
    for (int i = 0; i < ARKIT_SHAPES; i++)
        right[i] -= (arkit_table[i].rare ? FEW_RARE : FEW) * sqrt(solver->squares.gram[i][i]);
    box_squares_solve(&solver->squares, right);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        weights[i] = solver->squares.x[i];
    weights[ARKIT_JAW_OPEN] = fmin(1, weights[ARKIT_JAW_OPEN] + weights[ARKIT_MOUTH_CLOSE]);
    double tip = arkit_table[ARKIT_TONGUE_OUT].faps[45] - TIP_AT_TEETH;
    weights[ARKIT_TONGUE_OUT] = fmin(1, fmax(0, (value_of(frame, 45) - TIP_AT_TEETH) / tip));
    close_lips(frame, weights);
    close_lids(frame, weights);
}

static bool is_moved(int fap) {
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (arkit_table[i].faps[fap])
            return true;
    return false;
}

/* Radians to units of 1e-5; a head turns by half a circle at most. */
static double turn_of(double radians) {
    return 1e5 * fmin(3.14159, fmax(-3.14159, radians));
}

void arkit_faps(const double weights[ARKIT_SHAPES], const struct arkit_turns *head, struct fap_frame *frame) {
    double w[ARKIT_SHAPES], values[FAP_COUNT + 1] = {0};
    for (int i = 0; i < ARKIT_SHAPES; i++)
        w[i] = fmin(1, fmax(0, weights[i]));
    w[ARKIT_MOUTH_CLOSE] = fmin(w[ARKIT_MOUTH_CLOSE], w[ARKIT_JAW_OPEN]);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        for (int n = 3; n <= FAP_COUNT; n++)
            values[n] += w[i] * arkit_table[i].faps[n];
    double tongue = w[ARKIT_TONGUE_OUT], tip = arkit_table[ARKIT_TONGUE_OUT].faps[45];
    values[45] = TIP_AT_TEETH * fmin(1, tongue / TONGUE_OUT_LEAST) + tongue * (tip - TIP_AT_TEETH);
    for (int side = 0; side < LIDS; side++) {
        double shut = values[lids[side][0]] + values[lids[side][1]];
        for (int i = 0; i < 2 && shut > LIDS_MEET; i++)
            values[lids[side][i]] *= LIDS_MEET / shut;
    }
    values[48] = turn_of(head->head_pitch);
    values[49] = turn_of(head->head_yaw);
    values[50] = turn_of(head->head_roll);
    *frame = (struct fap_frame){0};
    for (int n = 3; n <= FAP_COUNT; n++)
        if ((n >= 48 && n <= 50) || is_moved(n))
            fap_frame_set(frame, n, (int32_t)lround(values[n]));
}

struct arkit_turns arkit_turns_of(const struct fap_frame *frame) {
    const double rad = 1e-5;
    return (struct arkit_turns){.head_yaw = rad * value_of(frame, 49),
                                .head_pitch = rad * value_of(frame, 48),
                                .head_roll = rad * value_of(frame, 50),
                                .eye_yaw = {rad * value_of(frame, 23), rad * value_of(frame, 24)},
                                .eye_pitch = {rad * value_of(frame, 25), rad * value_of(frame, 26)}};
}
