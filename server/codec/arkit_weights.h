/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames of FAPs as weights of ARKit's 52 face shapes (models/shapes/arkit.json): least squares within 0..1
 * over what the FAPs move, in mm. Lips that touch touch there, too, and so do lids: that weighs most, and
 * what is left of it is taken away afterwards. */
#ifndef FACCIA_CODEC_ARKIT_WEIGHTS_H
#define FACCIA_CODEC_ARKIT_WEIGHTS_H

#include "protocol/fap.h"
#include "server/codec/arkit_table.h"
#include <stdbool.h>
#include <stddef.h>

struct arkit_solver;

struct arkit_solver *arkit_solver_new(void);
void arkit_solver_free(struct arkit_solver *solver);

/* Into weights, each 0..1, in the table's order. The same frame gives the same weights, whatever came before.
 * mouthClose never goes beyond jawOpen. */
void arkit_weights(struct arkit_solver *solver, const struct fap_frame *frame, double weights[ARKIT_SHAPES]);

/* What is no shape: turns in rad, as FAPs 23 to 26 and 48 to 50 have them. */
struct arkit_turns {
    double head_yaw, head_pitch, head_roll; /* to the head's left, down, to its right shoulder */
    double eye_yaw[2], eye_pitch[2];        /* left eye, right eye: to the left, down */
};
struct arkit_turns arkit_turns_of(const struct fap_frame *frame);

/* How far apart the weights leave the lips in the middle (0), left (1) and right (2), FAP units of MNS; 0 or
 * less = they touch. */
double arkit_gap(const double weights[ARKIT_SHAPES], int pair);

/* Least squares within a box: the x of 0 <= x <= most that makes |A x - b|^2 + ridge |x|^2 smallest, by the
 * method of active sets on the normal equations (P. B. Stark and R. L. Parker, "Bounded-variable least
 * squares", Computational Statistics 10, 1995). With a ridge above 0 there is one such x, whatever it is
 * looked for from. */

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
