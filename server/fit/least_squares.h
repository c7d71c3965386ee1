/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nonlinear least squares by a trust-region method with a two-dimensional subspace (Byrd, Schnabel and
 * Shultz, Mathematical Programming 40, 1988), from the GNU Scientific Library. */
#ifndef FACCIA_FIT_LEAST_SQUARES_H
#define FACCIA_FIT_LEAST_SQUARES_H

#include <stddef.h>

struct least_squares {
    size_t residuals, unknowns; /* at least as many residuals as unknowns */
    void *ctx;
    void (*residual)(void *ctx, const double *x, double *out);
    /* d residual i / d unknown j into out[i * stride + j]; out comes as zeros */
    void (*jacobian)(void *ctx, const double *x, double *out, size_t stride);
    void (*progress)(void *ctx, int iteration, double sum); /* may be NULL */
};

/* Improves x for at most that many iterations; ends sooner where no step makes the sum of squares smaller.
 * Returns that sum. */
double least_squares_run(const struct least_squares *problem, double *x, int iterations);

#endif
