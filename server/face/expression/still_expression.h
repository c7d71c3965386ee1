/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One expression alone on a face that neither speaks nor lives, for lists and pictures. */
#ifndef FACCIA_FACE_EXPRESSION_STILL_EXPRESSION_H
#define FACCIA_FACE_EXPRESSION_STILL_EXPRESSION_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"

/* The entry with that index, its pose held and its gesture at the strongest key. intensity 0..1. Sets FAPs 2
 * to 68. */
void still_expression(const struct expressions *expressions, size_t index, double intensity,
                      struct fap_frame *frame);

#endif
