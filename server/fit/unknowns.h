/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients as unknowns without limits: x, from which the solver may step anywhere, is how far a value
 * lies from the one that the pack has, and stands for a value inside the limits of anatomy and of a speech
 * pack. */
#ifndef FACCIA_FIT_UNKNOWNS_H
#define FACCIA_FIT_UNKNOWNS_H

#include "server/face/engines/targets.h"

/* Of one segment: all but k, which the curve shows only by passing DOMINANCE_RESISTANT, so that it has no
 * slope. The original function has no shape and one c. */
enum { UNKNOWNS_LOOK_AHEAD = 11, UNKNOWNS_ORIGINAL = 6, UNKNOWNS_MOST = UNKNOWNS_LOOK_AHEAD };

/* The first ones, t and T, which a phone has of its own in each context; the rest it shares with its group.
 */
enum { UNKNOWNS_TARGET = 2, UNKNOWNS_T = 1 };

size_t unknowns_count(enum targets_function function);

/* The coefficients of parameter p that lie x away from those of the base. x = 0 gives the base itself, as
 * does a base without dominance: the curve glides past it, by rule. */
struct coefficients unknowns_moved(enum targets_function function, const struct coefficients *base, int p,
                                   const double *x);

/* The target, mm, as near to it as anatomy allows. */
double unknowns_limited(int p, double T);

/* How far the unknown may be expected to lie from the pack's: what a move is measured in. */
double unknowns_spread(enum targets_function function, size_t unknown);

#endif
