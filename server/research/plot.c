/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/plot.h"
#include <math.h>
#include <stdio.h>

struct svg_style svg_style(size_t index) {
    static const struct svg_style styles[] = {
        {"#0072b2", "none"}, {"#d55e00", "7 3"},      {"#009e73", "2 3"}, {"#cc79a7", "9 3 2 3"},
        {"#000000", "4 2"},  {"#e69f00", "12 3 4 3"}, {"#56b4e9", "1 2"}, {"#666666", "6 2 1 2 1 2"},
    };
    return styles[index % (sizeof styles / sizeof *styles)];
}

static void escape(struct buf *out, const char *text) {
    for (; *text; text++) {
        if (*text == '<')
            buf_printf(out, "&lt;");
        else if (*text == '>')
            buf_printf(out, "&gt;");
        else if (*text == '&')
            buf_printf(out, "&amp;");
        else if ((unsigned char)*text >= ' ')
            buf_add(out, text, 1);
    }
}

void svg_begin(struct buf *out, double width, double height, const char *title) {
    buf_printf(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
               "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"%g\" height=\"%g\" "
               "viewBox=\"0 0 %g %g\" font-family=\"sans-serif\">\n<title>",
               width, height, width, height);
    escape(out, title);
    buf_printf(out, "</title>\n<rect width=\"%g\" height=\"%g\" fill=\"#ffffff\"/>\n", width, height);
}

void svg_end(struct buf *out) {
    buf_printf(out, "</svg>\n");
}

void svg_text(struct buf *out, double x, double y, double size, const char *anchor, const char *text) {
    buf_printf(out, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%g\" text-anchor=\"%s\" fill=\"#222222\">", x, y,
               size, anchor);
    escape(out, text);
    buf_printf(out, "</text>\n");
}

static double svg_x(const struct svg_axes *a, double x) {
    return a->left + (x - a->x_min) / (a->x_max - a->x_min) * a->width;
}

static double svg_y(const struct svg_axes *a, double y) {
    return a->top + a->height - (y - a->y_min) / (a->y_max - a->y_min) * a->height;
}

/* A round step that divides the range into about that many parts. */
static double svg_step(double range, int parts) {
    double raw = range / parts, power = pow(10, floor(log10(raw))), digit = raw / power;
    return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

static void tick_text(struct buf *out, double x, double y, const char *anchor, double value) {
    buf_printf(
        out, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"10\" text-anchor=\"%s\" fill=\"#444444\">%.4g</text>\n",
        x, y, anchor, fabs(value) < 1e-9 ? 0 : value);
}

void svg_axes(struct buf *out, const struct svg_axes *a, const char *title, const double *x_ticks,
              size_t x_tick_count) {
    double y_step = svg_step(a->y_max - a->y_min, 5), x_step = svg_step(a->x_max - a->x_min, 8);
    svg_text(out, a->left, a->top - 8, 12, "start", title);
    for (double y = ceil(a->y_min / y_step) * y_step; y <= a->y_max + y_step * 1e-6; y += y_step) {
        buf_printf(out, "<path d=\"M%.1f %.1fh%.1f\" stroke=\"%s\" fill=\"none\"/>\n", a->left, svg_y(a, y),
                   a->width, fabs(y) < y_step * 1e-6 ? "#888888" : "#e4e4e4");
        tick_text(out, a->left - 5, svg_y(a, y) + 3.5, "end", y);
    }
    for (size_t i = 0; i < x_tick_count; i++)
        tick_text(out, svg_x(a, x_ticks[i]), a->top + a->height + 14, "middle", x_ticks[i]);
    for (double x = ceil(a->x_min / x_step) * x_step; !x_ticks && x <= a->x_max + x_step * 1e-6; x += x_step)
        tick_text(out, svg_x(a, x), a->top + a->height + 14, "middle", x);
    buf_printf(
        out,
        "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"#aaaaaa\"/>\n",
        a->left, a->top, a->width, a->height);
}

/* Shades a range over the full height. */
static void svg_band(struct buf *out, const struct svg_axes *a, double from, double to, const char *colour) {
    buf_printf(out, "<rect x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%.1f\" fill=\"%s\"/>\n",
               svg_x(a, from), a->top, svg_x(a, to) - svg_x(a, from), a->height, colour);
}

void svg_line(struct buf *out, const struct svg_axes *a, const double *x, const double *y, size_t count,
              struct svg_style style, bool dots) {
    bool drawing = false;
    buf_printf(out, "<path d=\"M");
    for (size_t i = 0; i < count; i++) {
        if (isnan(y[i]))
            continue;
        buf_printf(out, "%s%.1f %.1f", drawing ? "L" : "", svg_x(a, x[i]), svg_y(a, y[i]));
        drawing = true;
    }
    if (!drawing)
        buf_printf(out, "%.1f %.1f", a->left, a->top);
    buf_printf(out, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.8\" stroke-dasharray=\"%s\"/>\n",
               style.colour, style.dashes);
    for (size_t i = 0; dots && i < count; i++)
        if (!isnan(y[i]))
            buf_printf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.4\" fill=\"%s\"/>\n", svg_x(a, x[i]),
                       svg_y(a, y[i]), style.colour);
}

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
