/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least squares within a box: the x of 0 <= x <= most that makes |A x - b|^2 + ridge |x|^2 smallest, by the
 * method of active sets on the normal equations (P. B. Stark and R. L. Parker, "Bounded-variable least
 * squares", Computational Statistics 10, 1995). With a ridge above 0 there is one such x, whatever it is
 * looked for from. */
#ifndef FACCIA_CODEC_BOX_SQUARES_H
#define FACCIA_CODEC_BOX_SQUARES_H

#include <stddef.h>

enum { BOX_SQUARES_MAX = 56 };

/* The first three are the problem's, the rest is what the solver keeps from one right side to the next: near
 * ones are found in a few steps. It allocates nothing. */
struct box_squares {
    size_t count;
    double gram[BOX_SQUARES_MAX][BOX_SQUARES_MAX]; /* A'A + ridge on the diagonal */
    double most[BOX_SQUARES_MAX];                  /* above 0 */
    double x[BOX_SQUARES_MAX];
    signed char at[BOX_SQUARES_MAX]; /* -1 held at 0, 1 held at most, 0 free */
    double factor[BOX_SQUARES_MAX][BOX_SQUARES_MAX];
};

/* All are held at 0. After the problem has been filled in, and as often as one likes. */
void box_squares_begin(struct box_squares *s);

/* Finds s->x for A'b = right. Returns the steps that it took; at most 10 for each variable. */
size_t box_squares_solve(struct box_squares *s, const double *right);

/* The largest violation of the conditions of Karush, Kuhn and Tucker at s->x: 0 where it is the smallest. */
double box_squares_violation(const struct box_squares *s, const double *right);

#endif
