/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/curve_match.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

/* A curve whose standard deviation is less than this part of its size stands still: the rest is rounding. */
#define STILL 1e-9

struct curve_match curve_match(const double *y, const double *f, size_t count) {
    struct curve_match out = {count, NAN, NAN, NAN};
    double my = 0, mf = 0, yy = 0, ff = 0, yf = 0, dd = 0, n = (double)count;
    if (!count)
        return out;
    for (size_t i = 0; i < count; i++) {
        my += y[i] / n;
        mf += f[i] / n;
    }
    for (size_t i = 0; i < count; i++) {
        double a = y[i] - my, b = f[i] - mf;
        yy += a * a / n;
        ff += b * b / n;
        yf += a * b / n;
        dd += (a - b) * (a - b) / n;
    }
    out.offset_rms = sqrt(dd);
    out.affine_rms = sqrt(yy);
    if (sqrt(yy) > STILL * (1 + fabs(my)) && sqrt(ff) > STILL * (1 + fabs(mf))) {
        out.correlation = yf / sqrt(yy * ff);
        out.affine_rms = sqrt(fmax(0, yy - yf * yf / ff));
    }
    return out;
}

struct curve_match_shifted curve_match_shifted(const double *times, const double *y, size_t count,
                                               double (*predict)(void *ctx, double t), void *ctx,
                                               double always) {
    struct curve_match_shifted out = {0};
    double *f = mem_alloc((count + 1) * sizeof *f);
    int steps = (int)lround(CURVE_SHIFT_MOST / CURVE_SHIFT_STEP);
    for (int s = -steps - 1; s <= steps; s++) {
        double shift = s < -steps ? 0 : s * CURVE_SHIFT_STEP; /* first as it is */
        for (size_t i = 0; i < count; i++)
            f[i] = predict(ctx, times[i] - always - shift);
        struct curve_match m = curve_match(y, f, count);
        if (s < -steps)
            out.as_is = out.best = m;
        else if (m.correlation > out.best.correlation) {
            out.best = m;
            out.shift = shift;
        }
    }
    free(f);
    return out;
}
