/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/listening/results_plot.h"
#include "server/base/mem.h"
#include "server/export/svg.h"
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 56, TOP = 66, HEIGHT = 300, WIDTH = 620, BOX = 90, BOX_MARGIN = 40, LEGEND = 200 };

/* Number of cells of the same ratio, from cell i on. */
static size_t same_ratio(const struct results *r, size_t i) {
    size_t n = 1;
    while (i + n < r->count && r->cells[i + n].snr == r->cells[i].snr)
        n++;
    return n;
}

/* The modes in order of first appearance. Returns their number; the caller frees the list. */
static size_t list_modes(const struct results *r, const char ***modes) {
    size_t count = 0, k;
    *modes = mem_alloc((r->count + 1) * sizeof **modes);
    for (size_t i = 0; i < r->count; i++) {
        for (k = 0; k < count && strcmp((*modes)[k], r->cells[i].mode) != 0; k++)
            ;
        if (k == count)
            (*modes)[count++] = r->cells[i].mode;
    }
    return count;
}

static double y_of(const struct svg_axes *a, double percent) {
    return a->top + a->height * (1 - (percent - a->y_min) / (a->y_max - a->y_min));
}

/* A mean with its standard error. */
static void draw_error(struct buf *out, const struct svg_axes *axes, const struct result_cell *cell,
                       const char *colour) {
    double error = 100 * sqrt(cell->group.variance / cell->group.n), mean = 100 * cell->group.mean;
    double x = svg_x(axes, cell->snr), high = y_of(axes, fmin(105, mean + error)),
           low = y_of(axes, fmax(0, mean - error));
    buf_printf(out, "<path d=\"M%.1f %.1fV%.1fM%.1f %.1fh10M%.1f %.1fh10\" stroke=\"%s\" fill=\"none\"/>\n",
               x, high, low, x - 5, high, x - 5, low, colour);
}

void results_plot_correct(const struct results *r, struct buf *out) {
    const char **modes;
    size_t count = list_modes(r, &modes), ratios = 0;
    double *x = mem_alloc(3 * r->count * sizeof *x), *y = x + r->count, *ticks = y + r->count;
    double least = r->cells[r->count - 1].snr, most = r->cells[0].snr,
           margin = fmax(1, 0.06 * (most - least));
    struct svg_axes axes = {LEFT, TOP, WIDTH - LEFT - 30, HEIGHT, least - margin, most + margin, 0, 105};
    svg_begin(out, WIDTH, TOP + HEIGHT + 50, "Correct answers by signal-to-noise ratio");
    for (size_t i = 0; i < r->count; i += same_ratio(r, i))
        ticks[ratios++] = r->cells[i].snr;
    svg_axes(out, &axes, "Correct answers, %, mean of the listeners with its standard error", ticks, ratios);
    svg_text(out, LEFT + axes.width / 2, TOP + HEIGHT + 38, 12, "middle", "signal-to-noise ratio, dB");
    for (size_t m = 0; m < count; m++) {
        struct svg_style style = svg_style(m);
        double at = LEFT + LEGEND * (double)(m % 3);
        size_t points = 0;
        for (size_t i = r->count; i--;)
            if (!strcmp(r->cells[i].mode, modes[m])) {
                x[points] = r->cells[i].snr;
                y[points++] = 100 * r->cells[i].group.mean;
                draw_error(out, &axes, &r->cells[i], style.colour);
            }
        svg_line(out, &axes, x, y, points, style, true);
        buf_printf(out,
                   "<path d=\"M%.1f %.1fh34\" stroke=\"%s\" stroke-width=\"2.4\" stroke-dasharray=\"%s\"/>\n",
                   at, 20 + 16 * (double)(m / 3), style.colour, style.dashes);
        svg_text(out, at + 40, 24 + 16 * (double)(m / 3), 12, "start", modes[m]);
    }
    svg_end(out);
    free(x);
    free(modes);
}

static void draw_box(struct buf *out, const struct svg_axes *axes, double x, const struct result_cell *cell,
                     const char *colour) {
    enum { LEAST, LOWER, MEDIAN, UPPER, MOST, MARKS };
    size_t n = (size_t)cell->group.n;
    double y[MARKS], half = BOX / 4.0;
    for (int i = 0; i < MARKS; i++)
        y[i] = y_of(axes, 100 * gsl_stats_quantile_from_sorted_data(cell->shares, 1, n, i / 4.0));
    buf_printf(out,
               "<path d=\"M%.1f %.1fh%.1fM%.1f %.1fV%.1fM%.1f %.1fV%.1fM%.1f %.1fh%.1f\" stroke=\"%s\" "
               "fill=\"none\"/>\n",
               x - half / 2, y[LEAST], half, x, y[LEAST], y[LOWER], x, y[UPPER], y[MOST], x - half / 2,
               y[MOST], half, colour);
    buf_printf(out,
               "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" stroke=\"%s\" fill=\"#ffffff\"/>\n"
               "<path d=\"M%.1f %.1fh%.1f\" stroke=\"%s\" stroke-width=\"2.4\"/>\n",
               x - half, y[UPPER], 2 * half, y[LOWER] - y[UPPER], colour, x - half, y[MEDIAN], 2 * half,
               colour);
}

void results_plot_listeners(const struct results *r, struct buf *out) {
    const char **modes;
    size_t count = list_modes(r, &modes), ratios = 0;
    for (size_t i = 0; i < r->count; i += same_ratio(r, i))
        ratios++;
    double panel = BOX * (double)count + BOX_MARGIN, left = LEFT;
    double width = fmax(WIDTH, LEFT + panel * (double)ratios + 20), none[] = {-1};
    svg_begin(out, width, TOP + HEIGHT + 50 + 16 * (double)count, "Listeners' shares of correct answers");
    svg_text(out, LEFT, 24, 14, "start",
             "Correct answers of each listener, %: least, quartiles, median, greatest");
    for (size_t i = 0, n; i < r->count; i += n, left += panel) {
        struct svg_axes axes = {left, TOP, panel - BOX_MARGIN, HEIGHT, 0, (double)count, 0, 105};
        char title[40], number[24];
        n = same_ratio(r, i);
        snprintf(title, sizeof title, "%g dB", r->cells[i].snr);
        svg_axes(out, &axes, title, none, 0);
        for (size_t k = i; k < i + n; k++)
            for (size_t m = 0; m < count; m++)
                if (!strcmp(r->cells[k].mode, modes[m])) {
                    double x = svg_x(&axes, (double)m + 0.5);
                    draw_box(out, &axes, x, &r->cells[k], svg_style(m).colour);
                    snprintf(number, sizeof number, "(%zu)", m + 1);
                    svg_text(out, x, TOP + HEIGHT + 34, 12, "middle", number);
                }
    }
    for (size_t m = 0; m < count; m++) {
        char text[RESULTS_NAME_BYTES + 24];
        snprintf(text, sizeof text, "(%zu) %s", m + 1, modes[m]);
        svg_text(out, LEFT, TOP + HEIGHT + 54 + 16 * (double)m, 12, "start", text);
    }
    svg_end(out);
    free(modes);
}
