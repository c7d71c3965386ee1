/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A score as text for people: what a reader understood. One line for each sentence, its items indented below
 * it, and then the cues. Places are bytes of the input. What has its usual value is left out. */
#ifndef FACCIA_MARKUP_SCORE_DUMP_H
#define FACCIA_MARKUP_SCORE_DUMP_H

#include "server/base/buf.h"
#include "server/markup/score.h"

void score_dump(const struct score *score, struct buf *out);

#endif
