/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What makes a pack's coefficients those of the original function of Cohen and Massaro (1993). */
#ifndef FACCIA_FACE_ENGINES_ORIGINAL_H
#define FACCIA_FACE_ENGINES_ORIGINAL_H

#include "server/face/packs/speech_pack_content.h"

/* The packs' extents and degrees were found beside the resistance, which ends segments; without it they would
 * reach over half a sentence and nothing would ever close. Here they are multiplied, for each parameter, by
 * the two factors with which the original function comes nearest to the way through the same targets:
 * tests/bench/baseline.c finds them. */
struct coefficients original_coefficients(const struct coefficients *c, int param);

#endif
