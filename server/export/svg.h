/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Line charts in SVG 1.1, written into a buffer. */
#ifndef FACCIA_EXPORT_SVG_H
#define FACCIA_EXPORT_SVG_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Colours and dashes of lines, cycled; readable with any colour vision (Okabe and Ito, 2008). */
struct svg_style {
    const char *colour, *dashes;
};
struct svg_style svg_style(size_t index);

void svg_begin(struct buf *out, double width, double height, const char *title);
void svg_end(struct buf *out);

/* anchor: "start", "middle", "end". The text must not contain control characters. */
void svg_text(struct buf *out, double x, double y, double size, const char *anchor, const char *text);

/* A frame with its scale: maps data coordinates to the rectangle left, top, width, height. */
struct svg_axes {
    double left, top, width, height;
    double x_min, x_max, y_min, y_max;
};

/* Draws frame, grid and numbers; x_ticks: positions of numbers on the x axis, or NULL for round steps. */
void svg_axes(struct buf *out, const struct svg_axes *a, const char *title, const double *x_ticks,
              size_t x_tick_count);

/* Draws a line through the points that are not NAN, optionally with dots. */
void svg_line(struct buf *out, const struct svg_axes *a, const double *x, const double *y, size_t count,
              struct svg_style style, bool dots);

/* Maps an x coordinate of the data to the picture. */
double svg_x(const struct svg_axes *a, double x);

/* Fills the space between two lines where both are not NAN. */
void svg_area(struct buf *out, const struct svg_axes *a, const double *x, const double *low,
              const double *high, size_t count, const char *colour);

/* Shades a range over the full height. */
void svg_band(struct buf *out, const struct svg_axes *a, double from, double to, const char *colour);

#endif
