/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/plot.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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
             "Gap of the inner lips, mm, over seconds, at %g words per minute (blue: lips must close; "
             "yellow: must touch the teeth)",
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
             "Measures by requested speech rate, words per minute");
    svg_end(out);
}

/* ---- a fitted speaker ---- */

enum { PANEL = 350, PANEL_TOP = 66, SHAPE_HEIGHT = 170, DOMINANCE_TOP = 228, DOMINANCE_HEIGHT = 76 };
enum { DRAWN_RECORDED, DRAWN_BEFORE, DRAWN_AFTER, DRAWN };

static struct svg_style drawn_style(int line) {
    static const size_t styles[DRAWN] = {0, 7, 1};
    return svg_style(styles[line]);
}

static void draw_fit_legend(const struct fit_plot *p, const char *title, struct buf *out) {
    char text[DRAWN][80] = {"recorded"};
    bool spread = false;
    for (size_t i = 0; i < p->count; i++)
        spread |= p->recordings[i].spread[p->param] != NULL;
    if (spread)
        snprintf(text[DRAWN_RECORDED], sizeof text[0], "recorded: mean ± s.d.");
    snprintf(text[DRAWN_BEFORE], sizeof text[0], "before the fit: %.3f mm", p->unfitted);
    snprintf(text[DRAWN_AFTER], sizeof text[0], "fitted: %.3f mm", p->fitted);
    svg_text(out, LEFT, 24, 16, "start", title);
    for (int i = 0; i < DRAWN; i++) {
        struct svg_style style = drawn_style(i);
        double x = LEFT + 240.0 * i;
        buf_printf(out,
                   "<path d=\"M%.1f 40h34\" stroke=\"%s\" stroke-width=\"2.4\" stroke-dasharray=\"%s\"/>\n",
                   x, style.colour, style.dashes);
        svg_text(out, x + 40, 44, 12, "start", text[i]);
    }
}

static void draw_phones(const struct measured_speech *r, const struct svg_axes *axes, double height,
                        struct buf *out) {
    for (size_t i = 0; i < r->phone_count; i++) {
        const struct recorded_phone *phone = &r->phones[i];
        buf_printf(out, "<path d=\"M%.1f %.1fv%.1f\" stroke=\"#bbbbbb\" stroke-width=\"0.7\"/>\n",
                   svg_x(axes, phone->start), axes->top, height);
        svg_text(out, svg_x(axes, (phone->start + phone->end) / 2), axes->top + axes->height + 31, 13,
                 "middle", phone->ipa[0] ? phone->ipa : "·");
    }
}

/* D R of each segment, alternately in two colours. */
static void draw_dominance(const struct fit_plot *p, const struct measured_speech *r,
                           const struct svg_axes *axes, struct buf *out) {
    struct phone_segments g;
    struct curve curve;
    double *y = mem_alloc((r->frame_count + 1) * sizeof *y);
    measured_speech_segments(p->after, r, NULL, NULL, &g);
    targets_curve(p->after, &g, p->options->function, p->param, &curve);
    svg_axes(out, axes, "Dominance", NULL, 0);
    for (size_t i = 0; i < curve.count; i++) {
        const struct curve_segment *s = &curve.segments[i];
        for (size_t n = 0; n < r->frame_count; n++) {
            double tau = r->times[n] - s->at;
            y[n] = r->times[n] <= s->from || r->times[n] >= s->to
                       ? NAN
                       : dominance_degree(&s->c, tau) * dominance_resistance(tau, s->h_bw, s->h_fw);
        }
        svg_line(out, axes, r->times, y, r->frame_count, svg_style(2 + i % 2), false);
    }
    curve_free(&curve);
    phone_segments_free(&g);
    free(y);
}

static void draw_panel(const struct fit_plot *p, const struct measured_speech *r, double top,
                       struct buf *out) {
    size_t frames = r->frame_count;
    const double *y = r->curves[p->param], *spread = r->spread[p->param];
    double *all = mem_alloc((4 * frames + 1) * sizeof *all), *before = all, *after = all + frames,
           *low = all + 2 * frames, *high = all + 3 * frames, least = INFINITY, most = -INFINITY;
    char title[160];
    fit_shape(p->before, r, p->options, p->param, before);
    fit_shape(p->after, r, p->options, p->param, after);
    for (size_t i = 0; i < frames; i++) {
        low[i] = y[i] - (spread ? spread[i] : 0);
        high[i] = y[i] + (spread ? spread[i] : 0);
        least = fmin(least, fmin(low[i], fmin(before[i], after[i])));
        most = fmax(most, fmax(high[i], fmax(before[i], after[i])));
    }
    double margin = fmax(0.04 * (most - least), 0.1), left = r->times[0], right = r->times[frames - 1];
    double width = WIDTH - LEFT - 30;
    struct svg_axes axes = {LEFT, top, width, SHAPE_HEIGHT, left, right, least - margin, most + margin},
                    below = {LEFT, top + DOMINANCE_TOP, width, DOMINANCE_HEIGHT, left, right, 0, 1.05};
    snprintf(title, sizeof title, "%s, mm, over seconds", speech_params[p->param]);
    if (r->repetitions > 1)
        snprintf(title, sizeof title, "%s, mm, over seconds: %zu repetitions", speech_params[p->param],
                 r->repetitions);
    if (spread)
        svg_area(out, &axes, r->times, low, high, frames, "#d9e8f5");
    svg_axes(out, &axes, title, NULL, 0);
    draw_phones(r, &axes, DOMINANCE_TOP + DOMINANCE_HEIGHT, out);
    svg_line(out, &axes, r->times, y, frames, drawn_style(DRAWN_RECORDED), false);
    svg_line(out, &axes, r->times, before, frames, drawn_style(DRAWN_BEFORE), false);
    svg_line(out, &axes, r->times, after, frames, drawn_style(DRAWN_AFTER), false);
    draw_dominance(p, r, &below, out);
    free(all);
}

void fit_plot_draw(const struct fit_plot *p, struct buf *out) {
    size_t panels = p->count < FIT_PLOT_PANELS ? p->count : FIT_PLOT_PANELS;
    char title[160];
    snprintf(title, sizeof title, "Fit of %s to %zu recording%s", speech_params[p->param], p->count,
             p->count == 1 ? "" : "s");
    if (panels < p->count)
        snprintf(title, sizeof title, "Fit of %s to %zu recordings, of which %zu are shown",
                 speech_params[p->param], p->count, panels);
    svg_begin(out, WIDTH, PANEL_TOP + 12 + PANEL * (double)panels, title);
    draw_fit_legend(p, title, out);
    for (size_t i = 0; i < panels; i++)
        draw_panel(p, &p->recordings[i], PANEL_TOP + 12 + PANEL * (double)i, out);
    svg_end(out);
}
