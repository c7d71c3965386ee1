/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poses: some FAPs with their values. */
#ifndef FACCIA_EXPRESSION_POSE_H
#define FACCIA_EXPRESSION_POSE_H

#include "server/expression/recipe.h"
#include <stdbool.h>

/* Adds value to FAP fap. */
void pose_add(struct pose *pose, int fap, double value);
void pose_free(struct pose *pose);

/* The FAPs of a name: one of MPEG-4's ("open_jaw", "raise_l_cornerlip"), or one without its side for both
 * ("raise_cornerlip", "lower_t_lip_m"). Returns how many, 0 when there is none. */
size_t pose_faps_named(const char *name, int out[2]);

/* The outer contour of the lips follows the inner one where it is not given, and the eyes make up for what
 * the head does, unless the pose has a gaze of its own. */
void pose_complete(struct pose *pose, bool own_gaze);

/* Strengthens the left side by asymmetry, -1..1, and weakens the right one. */
void pose_unbalance(struct pose *pose, double asymmetry);

#endif
