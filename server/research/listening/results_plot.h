/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Charts of an intelligibility test, as SVG (Costa, MSc thesis, UNICAMP 2009, figures 6.3 and 6.4). */
#ifndef FACCIA_RESEARCH_LISTENING_RESULTS_PLOT_H
#define FACCIA_RESEARCH_LISTENING_RESULTS_PLOT_H

#include "server/base/buf.h"
#include "server/research/listening/results.h"

/* Draws the mean share of correct answers by signal-to-noise ratio, a line for each mode, with bars of one
 * standard error. There is at least one cell. */
void results_plot_correct(const struct results *results, struct buf *out);

/* Draws boxes of the listeners' shares, a panel for each ratio, a box for each mode: least, lower quartile,
 * median, upper quartile and greatest. All cells have their shares. */
void results_plot_listeners(const struct results *results, struct buf *out);

#endif
