/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints a score for people, to show what a reader understood: a line for each sentence, its items
 * indented below it, then the cues. Positions are bytes of the input. Default values are omitted. */
#ifndef FACCIA_MARKUP_SCORE_DUMP_H
#define FACCIA_MARKUP_SCORE_DUMP_H

#include "server/base/buf.h"
#include "server/markup/score.h"

void score_dump(const struct score *score, struct buf *out);

#endif
