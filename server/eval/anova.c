/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/anova.h"
#include <math.h>

/* The continued fraction of DLMF 8.17.22, by the modified Lentz method; converges fast for x < (a + 1) / (a +
 * b + 2). */
static double fraction(double a, double b, double x) {
    const double tiny = 1e-300;
    double value = 1, c = 1, d = 0, step = 0;
    for (int n = 1; n < 2000 && fabs(step - 1) > 1e-15; n++) {
        double m = n / 2; /* whole */
        double numerator = n % 2 ? -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
                                 : m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 + numerator * d;
        d = 1 / (fabs(d) < tiny ? tiny : d);
        c = 1 + numerator / c;
        c = fabs(c) < tiny ? tiny : c;
        step = c * d;
        value *= step;
    }
    return 1 / value;
}

double anova_beta(double a, double b, double x) {
    if (x <= 0 || x >= 1)
        return x >= 1;
    double front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x));
    if (x < (a + 1) / (a + b + 2))
        return front * fraction(a, b, x) / a;
    return 1 - front * fraction(b, a, 1 - x) / b;
}

double anova_f_tail(double f, double df1, double df2) {
    if (isnan(f))
        return NAN;
    return isinf(f) ? 0 : anova_beta(df2 / 2, df1 / 2, df2 / (df2 + df1 * f));
}

struct anova_group anova_group(const double *values, size_t n) {
    struct anova_group g = {.n = (double)n};
    for (size_t i = 0; i < n; i++)
        g.mean += values[i] / g.n;
    for (size_t i = 0; i < n && n > 1; i++)
        g.variance += (values[i] - g.mean) * (values[i] - g.mean) / (g.n - 1);
    return g;
}

int anova_run(const struct anova_group *groups, size_t count, struct anova *out) {
    double total = 0, mean = 0;
    *out = (struct anova){.df_between = (double)count - 1};
    for (size_t i = 0; i < count; i++) {
        if (groups[i].n < 1)
            return -1;
        total += groups[i].n;
        mean += groups[i].n * groups[i].mean;
        out->within += (groups[i].n - 1) * groups[i].variance;
        out->df_within += groups[i].n - 1;
    }
    if (count < 2 || out->df_within < 1)
        return -1;
    mean /= total;
    for (size_t i = 0; i < count; i++)
        out->between += groups[i].n * (groups[i].mean - mean) * (groups[i].mean - mean);
    double squares = out->between / out->df_between;
    out->f = out->within > 0 ? squares / (out->within / out->df_within) : squares > 0 ? INFINITY : NAN;
    out->p = anova_f_tail(out->f, out->df_between, out->df_within);
    return 0;
}
