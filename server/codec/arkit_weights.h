/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames of FAPs as weights of ARKit's 52 face shapes (models/shapes/arkit.json): least squares within 0..1
 * over what the FAPs move, in mm. Lips that touch touch there, too, and so do lids: that weighs most, and
 * what is left of it is taken away afterwards. */
#ifndef FACCIA_CODEC_ARKIT_WEIGHTS_H
#define FACCIA_CODEC_ARKIT_WEIGHTS_H

#include "protocol/fap.h"
#include "server/codec/arkit_table.h"
#include <stdbool.h>

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

#endif
