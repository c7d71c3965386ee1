/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One-way analysis of variance from each group's size, mean and variance (Costa, MSc thesis, UNICAMP 2009,
 * chapter 6). */
#ifndef FACCIA_RESEARCH_LISTENING_RESULTS_H
#define FACCIA_RESEARCH_LISTENING_RESULTS_H

#include "server/base/error.h"
#include <stddef.h>
#include <stdint.h>

struct anova_group {
    double n, mean, variance; /* variance: of the sample, divided by n - 1 */
};

struct anova {
    double between, within; /* sums of squares */
    double df_between, df_within;
    double f; /* INFINITY when groups differ without variance within them; NAN without any variance */
    double p; /* probability of such an F if all groups are equal */
};

/* -1 for fewer than two groups, an empty group, or too few values to estimate the variance. */
int anova_run(const struct anova_group *groups, size_t count, struct anova *out);

/* Mean and variance of n > 0 values; the variance of one value is 0. */
struct anova_group anova_group(const double *values, size_t n);

/* The upper tail of the F distribution. */
double anova_f_tail(double f, double df1, double df2);

/* Results of an intelligibility test, read from CSV (RFC 4180: quoted fields, CRLF or LF; the first line
 * names the columns, whose order does not matter). */

enum { RESULTS_NAME_BYTES = 64 };

/* A condition: a mode of presentation at a signal-to-noise ratio. */
struct result_cell {
    double snr; /* dB */
    char mode[RESULTS_NAME_BYTES];
    struct anova_group group; /* proportions correct by listener */
    double *shares;           /* those proportions, ascending; NULL if only their mean is known */
};

/* Sorted by descending ratio; modes in order of first appearance. Begins zeroed. */
struct results {
    struct result_cell *cells;
    size_t count, cap;
};

/* A listener's answers in one condition. */
struct vote {
    char listener[RESULTS_NAME_BYTES], mode[RESULTS_NAME_BYTES];
    double snr;
    unsigned answers, right;
};

/* Begins zeroed. */
struct votes {
    struct vote *items;
    size_t count, cap;
};

/* Adds a file with the columns listener, mode, snr, correct (1 or 0; empty if the word was not presented
 * completely, which is not counted), one line per answer. -1 with *e ("bad-results"). */
int votes_read(struct votes *votes, const char *text, size_t size, struct error *e);
void votes_free(struct votes *votes);

/* Computes each listener's proportion in each condition. */
void results_from_votes(const struct votes *votes, struct results *out);

/* Reads the columns snr, mode, mean, variance, n. -1 with *e ("bad-results"). */
int results_read_means(const char *text, size_t size, struct results *out, struct error *e);
void results_free(struct results *results);

#endif
