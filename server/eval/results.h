/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of an intelligibility test, read from CSV (RFC 4180: quoted fields, CRLF or LF; the first line
 * names the columns, whose order does not matter). */
#ifndef FACCIA_EVAL_RESULTS_H
#define FACCIA_EVAL_RESULTS_H

#include "server/base/error.h"
#include "server/eval/anova.h"
#include <stdint.h>

enum { RESULTS_NAME_BYTES = 64 };

/* One mode of presentation at one signal-to-noise ratio. */
struct result_cell {
    double snr; /* dB */
    char mode[RESULTS_NAME_BYTES];
    struct anova_group group; /* of the listeners' proportions correct */
};

/* Cells of equal ratio stand together, the highest ratio first; modes in the order of their first appearance.
 * Begins zeroed. */
struct results {
    struct result_cell *cells;
    size_t count, cap;
};

/* How one listener did in one cell. */
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

/* Adds a file with the columns listener, mode, snr, correct (1 or 0; empty where the word was not presented
 * whole: it is not counted), one line for each answer. -1 with *e ("bad-results"). */
int votes_read(struct votes *votes, const char *text, size_t size, struct error *e);
void votes_free(struct votes *votes);

/* Each listener's proportion in each cell, gathered. */
void results_from_votes(const struct votes *votes, struct results *out);

/* Reads the columns snr, mode, mean, variance, n. -1 with *e ("bad-results"). */
int results_read_means(const char *text, size_t size, struct results *out, struct error *e);
void results_free(struct results *results);

#endif
