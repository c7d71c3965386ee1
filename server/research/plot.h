/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Charts of a comparison of engines, and of a fitted speaker, as SVG. */
#ifndef FACCIA_RESEARCH_PLOT_H
#define FACCIA_RESEARCH_PLOT_H

#include "server/export/svg.h"
#include "server/research/eval.h"
#include "server/research/fit.h"
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

/* Chart of a fit in one parameter (after Leone, "LUCIA-WebGL", figures 3.21 to 3.37), a panel for each
 * recording: the recorded curve, of repetitions the mean within one standard deviation; the pack's before and
 * after the fit, at the scale and level that suit the recording best; and below them the dominance of each
 * phone, with its resistance, after the fit. */

/* Recordings drawn; the others are only counted. */
enum { FIT_PLOT_PANELS = 12 };

struct fit_plot {
    int param;
    const struct measured_speech *recordings; /* with a curve of the parameter */
    size_t count;
    const struct speech_pack *before, *after;
    const struct fit_options *options;
    double unfitted, fitted; /* mm: errors of the curves drawn, over all recordings */
};

void fit_plot_draw(const struct fit_plot *p, struct buf *out);

#endif
