/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chart of a comparison of engines, as SVG. */
#ifndef FACCIA_RESEARCH_PLOT_H
#define FACCIA_RESEARCH_PLOT_H

#include "server/export/svg.h"
#include "server/research/eval.h"
#include <stdbool.h>

/* Chart of a comparison: the gap of the lips over a stretch at the slowest and fastest rate, then each
 * measure by rate, one line per engine. */

struct plot {
    const char *title;
    const char *const *engines;
    size_t engine_count; /* <= STRETCH_ENGINES */
    const double *rates; /* ascending */
    size_t rate_count;
    const double (*values)[EVAL_MEASURES]; /* [engine * rate_count + rate] */
    const struct stretch *slow, *fast;     /* fast is NULL when there is a single rate */
};

/* Appends an SVG 1.1 document. */
void plot_draw(const struct plot *p, struct buf *out);

#endif
