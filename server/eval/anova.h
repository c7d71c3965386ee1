/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One-way analysis of variance from each group's size, mean and variance (Costa, MSc thesis, UNICAMP 2009,
 * chapter 6). */
#ifndef FACCIA_EVAL_ANOVA_H
#define FACCIA_EVAL_ANOVA_H

#include <stddef.h>

struct anova_group {
    double n, mean, variance; /* variance: of the sample, divided by n - 1 */
};

struct anova {
    double between, within; /* sums of squares */
    double df_between, df_within;
    double f; /* INFINITY when nothing varies within the groups but they differ; NAN when nothing varies at
                 all */
    double p; /* the chance of such an F when all groups are alike */
};

/* -1 when there are fewer than two groups, an empty one, or nothing to estimate the variance from. */
int anova_run(const struct anova_group *groups, size_t count, struct anova *out);

/* Mean and variance of n > 0 values; the variance of one value is 0. */
struct anova_group anova_group(const double *values, size_t n);

/* The upper tail of the F distribution. */
double anova_f_tail(double f, double df1, double df2);

#endif
