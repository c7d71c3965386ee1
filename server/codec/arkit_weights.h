/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts FAP frames to weights of ARKit's 52 face shapes (models/shapes/arkit.json) by least squares
 * within 0..1 over the movements in mm. Lips and lids that touch weigh most, and any remaining gap is
 * removed afterwards. */
#ifndef FACCIA_CODEC_ARKIT_WEIGHTS_H
#define FACCIA_CODEC_ARKIT_WEIGHTS_H

#include "protocol/fap.h"
#include "server/codec/arkit_table.h"
#include <stdbool.h>
#include <stddef.h>

struct arkit_solver;

struct arkit_solver *arkit_solver_new(void);
void arkit_solver_free(struct arkit_solver *solver);

/* Computes weights, 0..1, in the table's order, independent of earlier frames. mouthClose never exceeds
 * jawOpen. */
void arkit_weights(struct arkit_solver *solver, const struct fap_frame *frame, double weights[ARKIT_SHAPES]);

/* Rotations of head and eyes, which have no shapes, in rad, from FAPs 23 to 26 and 48 to 50. */
struct arkit_turns {
    double head_yaw, head_pitch, head_roll; /* to the head's left, down, towards its right shoulder */
    double eye_yaw[2], eye_pitch[2];        /* left eye, right eye: to the left, down */
};
struct arkit_turns arkit_turns_of(const struct fap_frame *frame);

/* The reverse: sets all FAPs that shapes move, and those of the head. Weights are limited to 0..1, mouthClose
 * to jawOpen, and lids do not close beyond where they meet. */
void arkit_faps(const double weights[ARKIT_SHAPES], const struct arkit_turns *head, struct fap_frame *frame);

/* Gap between the lips in the middle (0), left (1) and right (2) for the weights, in FAP units of MNS; 0
 * or less = they touch. */
double arkit_gap(const double weights[ARKIT_SHAPES], int pair);

/* Bounded least squares: finds the x in 0 <= x <= most that minimises |A x - b|^2 + ridge |x|^2, with
 * active sets on the normal equations (P. B. Stark and R. L. Parker, "Bounded-variable least squares",
 * Computational Statistics 10, 1995). With a ridge above 0 the solution is unique and does not depend on
 * the starting point. */

enum { BOX_SQUARES_MAX = 56 };

/* The first three members define the problem; the rest is kept between right sides, so that similar ones
 * take few steps. Allocates nothing. */
struct box_squares {
    size_t count;
    double gram[BOX_SQUARES_MAX][BOX_SQUARES_MAX]; /* A'A + ridge on the diagonal */
    double most[BOX_SQUARES_MAX];                  /* above 0 */
    double x[BOX_SQUARES_MAX];
    signed char at[BOX_SQUARES_MAX]; /* -1 fixed at 0, 1 fixed at most, 0 free */
    double factor[BOX_SQUARES_MAX][BOX_SQUARES_MAX];
};

/* Resets all variables to 0. Call after filling in the problem; may be called again. */
void box_squares_begin(struct box_squares *s);

/* Solves for A'b = right into s->x. Returns the number of steps, at most 10 per variable. */
size_t box_squares_solve(struct box_squares *s, const double *right);

/* Returns the largest violation of the Karush-Kuhn-Tucker conditions at s->x; 0 = optimal. */
double box_squares_violation(const struct box_squares *s, const double *right);

#endif
