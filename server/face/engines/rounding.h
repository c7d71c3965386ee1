/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lips do between two rounded sounds. Speakers of English let them go and round them anew, speakers of
 * Turkish keep them round (S. E. Boyce, JASA 88, 1990: a trough and a plateau in the protrusion of /u_u/). */
#ifndef FACCIA_FACE_ENGINES_ROUNDING_H
#define FACCIA_FACE_ENGINES_ROUNDING_H

#include "server/face/engines/phone_segments.h"

/* c[i]: the coefficients of segment i of g for the parameter, to be changed: between two sounds that round
 * the lips, with no pause and nothing but sounds that do not care for rounding between them, those get as
 * their target what trough (0 plateau .. 1 to rest) leaves of the two's mean, and hold it; sounds with a
 * contact are left as they are. Does nothing for other parameters than AR, PI and PS. */
void rounding_trough(const struct phone_segments *g, enum speech_param param, double trough,
                     struct coefficients *c);

#endif
