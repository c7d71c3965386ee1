/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/export/svg.h"
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

double svg_x(const struct svg_axes *a, double x) {
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

void svg_band(struct buf *out, const struct svg_axes *a, double from, double to, const char *colour) {
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

void svg_area(struct buf *out, const struct svg_axes *a, const double *x, const double *low,
              const double *high, size_t count, const char *colour) {
    for (size_t i = 0, end; i < count; i = end + 1) {
        for (end = i; end < count && !isnan(low[end]) && !isnan(high[end]);)
            end++;
        if (end < i + 2)
            continue;
        buf_printf(out, "<path d=\"M");
        for (size_t k = i; k < end; k++)
            buf_printf(out, "%s%.1f %.1f", k > i ? "L" : "", svg_x(a, x[k]), svg_y(a, high[k]));
        for (size_t k = end; k-- > i;)
            buf_printf(out, "L%.1f %.1f", svg_x(a, x[k]), svg_y(a, low[k]));
        buf_printf(out, "Z\" fill=\"%s\"/>\n", colour);
    }
}
