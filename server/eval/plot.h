/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture of a comparison: the lips' gap over a stretch at the slowest and the fastest rate, then every
 * measure over the rates, one line for each engine. */
#ifndef FACCIA_EVAL_PLOT_H
#define FACCIA_EVAL_PLOT_H

#include "server/base/buf.h"
#include "server/eval/stretch.h"

struct plot {
    const char *title;
    const char *const *engines;
    size_t engine_count; /* <= STRETCH_ENGINES */
    const double *rates; /* rising */
    size_t rate_count;
    const double (*values)[EVAL_MEASURES]; /* [engine * rate_count + rate] */
    const struct stretch *slow, *fast;     /* the latter NULL when there is a single rate */
};

/* Appends an SVG 1.1 document. */
void plot_draw(const struct plot *p, struct buf *out);

#endif
