/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poses: sets of FAP values. */
#ifndef FACCIA_EXPRESSION_POSE_H
#define FACCIA_EXPRESSION_POSE_H

#include "server/expression/recipe.h"
#include <stdbool.h>

/* Adds value to FAP fap. */
void pose_add(struct pose *pose, int fap, double value);
void pose_free(struct pose *pose);

/* Finds the FAPs of an MPEG-4 name ("open_jaw", "raise_l_cornerlip"), or of a name without its side for
 * both ("raise_cornerlip", "lower_t_lip_m"). Returns their number, 0 if unknown. */
size_t pose_faps_named(const char *name, int out[2]);

/* Lets outer lips follow inner ones where not given, and eyes compensate head rotation unless the pose has
 * its own gaze. */
void pose_complete(struct pose *pose, bool own_gaze);

/* Strengthens the left side by asymmetry, -1..1, and weakens the right. */
void pose_unbalance(struct pose *pose, double asymmetry);

#endif
