/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/plot.h"
#include <math.h>
#include <stdio.h>

enum {
    WIDTH = 1100,
    LEFT = 56,
    TOP = 78,
    CURVE_HEIGHT = 190,
    CURVE_ROW = 262,
    COLUMNS = 3,
    CELL = 356,
    ROW = 196,
    CELL_HEIGHT = 128
};

static void draw_legend(const struct plot *p, struct buf *out) {
    enum { IN_ROW = 5 };
    svg_text(out, LEFT, 24, 16, "start", p->title);
    for (size_t i = 0; i < p->engine_count; i++) {
        struct svg_style style = svg_style(i);
        double x = LEFT + 208 * (double)(i % IN_ROW), y = 40 + 16 * (double)(i / IN_ROW);
        buf_printf(out,
                   "<path d=\"M%.1f %.0fh34\" stroke=\"%s\" stroke-width=\"2.4\" stroke-dasharray=\"%s\"/>\n",
                   x, y, style.colour, style.dashes);
        svg_text(out, x + 40, y + 4, 12, "start", p->engines[i]);
    }
}

static void draw_curves(const struct plot *p, const struct stretch *s, double rate, double top,
                        struct buf *out) {
    double x[STRETCH_STEPS + 1], y[STRETCH_STEPS + 1], highest = 1;
    char title[160];
    for (size_t i = 0; i < p->engine_count; i++)
        for (int k = 0; k <= STRETCH_STEPS; k++)
            highest = fmax(highest, (double)s->gaps[i][k]);
    struct svg_axes axes = {LEFT, top, WIDTH - LEFT - 30, CURVE_HEIGHT, 0, s->seconds, -1, ceil(highest)};
    for (size_t i = 0; i < s->span_count; i++)
        svg_band(out, &axes, s->spans[i].begin, s->spans[i].end, s->spans[i].teeth ? "#fdeccd" : "#d9e8f5");
    snprintf(title, sizeof title,
             "Gap of the inner lips, mm, over seconds, at %g words a minute (blue: lips have to close; "
             "yellow: to the teeth)",
             rate);
    svg_axes(out, &axes, title, NULL, 0);
    for (size_t i = 0; i < s->phone_count; i++) {
        const struct stretch_phone *phone = &s->phones[i];
        buf_printf(out, "<path d=\"M%.1f %.1fv%d\" stroke=\"#bbbbbb\" stroke-width=\"0.7\"/>\n",
                   svg_x(&axes, phone->start), top, CURVE_HEIGHT + 20);
        svg_text(out, svg_x(&axes, (phone->start + phone->end) / 2), top + CURVE_HEIGHT + 30, 13, "middle",
                 phone->label[0] ? phone->label : "·");
    }
    for (size_t i = 0; i < p->engine_count; i++) {
        for (int k = 0; k <= STRETCH_STEPS; k++) {
            x[k] = s->seconds * k / STRETCH_STEPS;
            y[k] = s->gaps[i][k];
        }
        svg_line(out, &axes, x, y, STRETCH_STEPS + 1, svg_style(i), false);
    }
}

static double factor(const struct eval_measure *m) {
    return m->unit == EVAL_SHARE || m->unit == EVAL_RATIO ? 100 : m->unit == EVAL_JERK ? 1e-3 : 1;
}

static void draw_measure(const struct plot *p, int which, double left, double top, struct buf *out) {
    static const char *const units[] = {"%", "%", "mm", "mm/s", "m/s³"};
    const struct eval_measure *m = &eval_measures[which];
    double lowest = 0, highest = m->unit == EVAL_SHARE || m->unit == EVAL_RATIO ? 105 : 0, y[p->rate_count];
    char title[160];
    for (size_t i = 0; i < p->engine_count * p->rate_count; i++) {
        double value = p->values[i][which] * factor(m);
        if (!isnan(value)) {
            lowest = fmin(lowest, value);
            highest = fmax(highest, 1.05 * value);
        }
    }
    if (highest <= lowest)
        highest = lowest + 1;
    double margin = p->rate_count > 1 ? 0.04 * (p->rates[p->rate_count - 1] - p->rates[0]) : 1;
    struct svg_axes axes = {
        left,   top,    CELL - 70, CELL_HEIGHT, p->rates[0] - margin, p->rates[p->rate_count - 1] + margin,
        lowest, highest};
    snprintf(title, sizeof title, "%s, %s", m->title, units[m->unit]);
    svg_axes(out, &axes, title, p->rates, p->rate_count);
    for (size_t i = 0; i < p->engine_count; i++) {
        for (size_t k = 0; k < p->rate_count; k++)
            y[k] = p->values[i * p->rate_count + k][which] * factor(m);
        svg_line(out, &axes, p->rates, y, p->rate_count, svg_style(i), true);
    }
}

void plot_draw(const struct plot *p, struct buf *out) {
    int curves = p->fast ? 2 : 1, rows = (EVAL_MEASURES + COLUMNS - 1) / COLUMNS;
    double top = TOP + curves * CURVE_ROW + 8;
    svg_begin(out, WIDTH, top + rows * ROW, p->title);
    draw_legend(p, out);
    draw_curves(p, p->slow, p->rates[0], TOP, out);
    if (p->fast)
        draw_curves(p, p->fast, p->rates[p->rate_count - 1], TOP + CURVE_ROW, out);
    for (int i = 0; i < EVAL_MEASURES; i++)
        draw_measure(p, i, LEFT + (i % COLUMNS) * CELL, top + 14 + (i / COLUMNS) * ROW, out);
    svg_text(out, WIDTH - 30, top + rows * ROW - 14, 11, "end",
             "Measures over the speech rate asked for, words a minute");
    svg_end(out);
}
