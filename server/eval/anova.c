/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/anova.h"
#include <gsl/gsl_cdf.h>
#include <math.h>

double anova_f_tail(double f, double df1, double df2) {
    if (isnan(f))
        return NAN;
    return isinf(f) ? 0 : gsl_cdf_fdist_Q(f, df1, df2);
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
