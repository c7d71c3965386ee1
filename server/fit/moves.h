/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What may move in a fit, from what all sounds share down to each of them, and what the moves make of a pack.
 * All unknowns together: the logarithm of the scale of all movements; a block for the consonants and one for
 * the vowels, which move as wholes; one for each viseme group; and for each entry its target. A phone's
 * coefficients are moved by the sum of its blocks, and its target is multiplied by the scale. */
#ifndef FACCIA_FIT_MOVES_H
#define FACCIA_FIT_MOVES_H

#include "server/fit/task.h"

/* Their number, and which of them that level lets move (into task->moving). */
size_t moves_count(const struct task *task);
void moves_choose(struct task *task, enum fit_level level);

/* Goes only that part of the way, in all but the scale. */
void moves_shrink(const struct task *task, double *x, double part);

/* What pulls an unknown back to 0, for each unit of it. */
double moves_pull(const struct task *task, size_t unknown);

/* Makes the pack what x stands for: all entries; or those that an unknown moves. */
void moves_apply(const struct task *task, const double *x);
void moves_apply_to(const struct task *task, const double *x, size_t unknown);

/* Whether the track has an entry that the unknown moves. */
bool moves_is_felt(const struct task *task, const struct fit_track *t, size_t unknown);

/* The other phones move with their kind, their group and the scale, so that what the recordings do not
 * contain fits what they do. Once only: it starts from what the pack holds. */
void moves_apply_to_others(const struct task *task, const double *x);

/* The scale for which the curves move as much as those of x = 0: then x changes their form alone. 1 where
 * nothing moves. */
double moves_same_amplitude(const struct task *task, const double *x);

#endif
