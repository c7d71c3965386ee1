/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/box_squares.h"
#include <math.h>
#include <stdbool.h>
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
