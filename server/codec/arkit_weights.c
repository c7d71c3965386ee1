/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least squares within a box: the x of 0 <= x <= most that makes |A x - b|^2 + ridge |x|^2 smallest, by the
 * method of active sets on the normal equations (P. B. Stark and R. L. Parker, "Bounded-variable least
 * squares", Computational Statistics 10, 1995). With a ridge above 0 there is one such x, whatever it is
 * looked for from. */
#include "server/codec/arkit_weights.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_EACH = 10 };

/* A gradient counts as 0 below this share of what its variable weighs. */
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

/* What the free variables would be if nothing bounded them, the others staying where they are. Cholesky. */
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

/* Goes towards what the free ones would be, as far as the box lets; what stops it is held there. Whether it
 * got there. */
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

/* How much better it would get inside the box, for one that is held; 0 or less = not. */
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

/* Of shapes that move alike few are taken: a shape has to explain more than so many mm. And where several
 * answers are as good, the smallest: mm^2 for a whole weight, beside the 20 to 400 that shapes have. */
#define FEW 0.02
#define FEW_RARE 0.15
#define RIDGE 0.001

/* What a mm of a gap between lips or lids weighs against a mm of anything else. */
#define GAP_WEIGHT 5.0

/* The tongue's tip as FAP 45 has it: up to 3 mm forward it is at the teeth and not out. */
#define TIP_AT_TEETH 61.0

/* From here on a blink is drawn to 1, which it is when the lids meet. */
#define LIDS_MEET 1024.0
#define NEARLY_SHUT 0.85

enum { PAIRS = 3, LIDS = 2 };

/* FAPs of lips and lids that face each other: they touch where a sum is 0, or LIDS_MEET. */
static const int lips[PAIRS][2] = {{4, 5}, {8, 10}, {9, 11}};
static const int lids[LIDS][2] = {{19, 21}, {20, 22}};

/* mm of one FAP unit: the face that arkit.json is meant on; an eyeball's turn shows 12 mm from its centre. */
static double length_of(int fap) {
    static const double units[] = {[FAP_UNIT_IRISD] = 11.7,
                                   [FAP_UNIT_ES] = 62,
                                   [FAP_UNIT_ENS] = 42,
                                   [FAP_UNIT_MNS] = 21,
                                   [FAP_UNIT_MW] = 50};
    return fap_table[fap].unit == FAP_UNIT_AU ? 12e-5 : units[fap_table[fap].unit] / 1024;
}

/* How much a mm of it counts. Outer contours follow the inner ones, cheeks follow the mouth; what no shape
 * moves does not count, nor does the tongue, whose one shape stands by itself. */
static double importance(int fap) {
    if (fap >= 51 && fap <= 60)
        return 0.3;
    if (fap == 3)
        return 0.6;
    if (fap == 18 || (fap >= 39 && fap <= 42))
        return 0.4;
    return (fap >= 43 && fap <= 50) || (fap >= 27 && fap <= 30) || fap < 3 || fap > 63 ? 0 : 1;
}

/* The solver's unknowns are the weights, but for two: instead of jawOpen it has how far the jaw is open with
 * the lips open, and instead of mouthClose how far with the lips closed. So mouthClose <= jawOpen, always. */
struct arkit_solver {
    struct box_squares squares;
    double columns[ARKIT_SHAPES][FAP_COUNT + 1]; /* what an unknown moves, FAP units */
    double right[ARKIT_SHAPES][FAP_COUNT + 1];   /* A'b from a frame's values */
};

/* The row of the metric for that FAP, applied to a column. */
static double weigh(const double *column, int fap) {
    double size = importance(fap) * length_of(fap), sum = size * size * column[fap];
    for (int i = 0; i < PAIRS + LIDS; i++) {
        const int *pair = i < PAIRS ? lips[i] : lids[i - PAIRS];
        double gap = GAP_WEIGHT * length_of(pair[0]);
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

/* The gap that one shape leaves between a pair of lips. */
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

/* Where the frame's lips touch and the weights' do not yet, all that opens them gives way; the jaw stays. */
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

struct arkit_turns arkit_turns_of(const struct fap_frame *frame) {
    const double rad = 1e-5;
    return (struct arkit_turns){.head_yaw = rad * value_of(frame, 49),
                                .head_pitch = rad * value_of(frame, 48),
                                .head_roll = rad * value_of(frame, 50),
                                .eye_yaw = {rad * value_of(frame, 23), rad * value_of(frame, 24)},
                                .eye_pitch = {rad * value_of(frame, 25), rad * value_of(frame, 26)}};
}
