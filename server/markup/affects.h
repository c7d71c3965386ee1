/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of affects in other vocabularies, and places on the disc of activation and evaluation. */
#ifndef FACCIA_MARKUP_AFFECTS_H
#define FACCIA_MARKUP_AFFECTS_H

#include <stdbool.h>

/* The APML affect that a category of EmotionML's vocabularies (big six, everyday, OCC, FSRE), or a vendor's
 * style, means; the name itself when it is none of those. */
const char *affect_meant(const char *name);

/* Whether the name is an affect of APML, or has the meaning of one. */
bool affect_is_known(const char *name);

/* The affect that lies in that direction; both -1..1. *intensity is the distance from the neutral middle, at
 * most 1. NULL in the middle. */
const char *affect_at(double activation, double evaluation, double *intensity);

#endif
