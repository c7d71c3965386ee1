/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How like two curves are. */
#ifndef FACCIA_EVAL_CURVE_MATCH_H
#define FACCIA_EVAL_CURVE_MATCH_H

#include <stddef.h>

/* NAN where it cannot be told: of a curve that stands still there is no correlation. */
struct curve_match {
    size_t count;
    double correlation; /* Pearson's */
    double offset_rms;  /* of y - f when f may be moved by a constant, in the curves' unit */
    double affine_rms;  /* when it may be scaled, too: sd(y) sqrt(1 - correlation^2) */
};

/* y is what was measured, f what was predicted. */
struct curve_match curve_match(const double *y, const double *f, size_t count);

/* Shifts that are tried, s; positive = the prediction is taken later. */
#define CURVE_SHIFT_MOST 0.06
#define CURVE_SHIFT_STEP 0.005

/* The match as it is, and with the shift that has the highest correlation. */
struct curve_match_shifted {
    struct curve_match as_is, best;
    double shift; /* of best, s */
};

/* predict(ctx, t): the prediction at t s. `always` (s) is added to every shift, 0 = as it is. */
struct curve_match_shifted curve_match_shifted(const double *times, const double *y, size_t count,
                                               double (*predict)(void *ctx, double t), void *ctx,
                                               double always);

#endif
