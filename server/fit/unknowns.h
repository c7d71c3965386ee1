/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients as unknowns without limits: x, from which the solver may step anywhere, stands for a value
 * inside the limits of a speech pack. */
#ifndef FACCIA_FIT_UNKNOWNS_H
#define FACCIA_FIT_UNKNOWNS_H

#include "server/face/engines/targets.h"

/* Of one segment: all but k, which the curve shows only by passing DOMINANCE_RESISTANT, so that it has no
 * slope. The original function has no shape and one c. */
enum { UNKNOWNS_LOOK_AHEAD = 11, UNKNOWNS_ORIGINAL = 6, UNKNOWNS_MOST = UNKNOWNS_LOOK_AHEAD };

size_t unknowns_count(enum targets_function function);
void unknowns_of(enum targets_function function, const struct coefficients *c, double *x);
/* Sets in *c what is unknown, and leaves the rest. */
void unknowns_to(enum targets_function function, const double *x, struct coefficients *c);
/* Has the value run to one of its limits? */
bool unknowns_at_limit(double x, size_t unknown);

/* The values to start from (thesis 3.4.3; T and t come from the data): strong segments resist and dominate
 * narrowly, weak ones give way. */
struct coefficients unknowns_start(bool strong, bool vowel);

#endif
