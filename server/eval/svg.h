/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Line charts in SVG 1.1, written into a buffer. */
#ifndef FACCIA_EVAL_SVG_H
#define FACCIA_EVAL_SVG_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Colour and dashes of the lines, cycled; readable with any colour vision (Okabe and Ito, 2008). */
struct svg_style {
    const char *colour, *dashes;
};
struct svg_style svg_style(size_t index);

void svg_begin(struct buf *out, double width, double height, const char *title);
void svg_end(struct buf *out);

/* anchor: "start", "middle", "end". The text may hold anything but control characters. */
void svg_text(struct buf *out, double x, double y, double size, const char *anchor, const char *text);

/* A frame with its scale: data coordinates go to the rectangle left, top, width, height. */
struct svg_axes {
    double left, top, width, height;
    double x_min, x_max, y_min, y_max;
};

double svg_x(const struct svg_axes *a, double x);
double svg_y(const struct svg_axes *a, double y);

/* Frame, grid and numbers on both sides; x_ticks: where the numbers of x stand, or NULL for round steps. */
void svg_axes(struct buf *out, const struct svg_axes *a, const char *title, const double *x_ticks,
              size_t x_tick_count);

/* A rectangle over the frame's whole height. */
void svg_band(struct buf *out, const struct svg_axes *a, double from, double to, const char *colour);

/* A line through the points that are not NAN, with dots at them if wanted. */
void svg_line(struct buf *out, const struct svg_axes *a, const double *x, const double *y, size_t count,
              struct svg_style style, bool dots);

/* A round step that cuts the range into about so many parts. */
double svg_step(double range, int parts);

#endif
