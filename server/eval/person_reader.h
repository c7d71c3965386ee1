/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lip reader that learnt from people: a nearest neighbour (lip_reader.h) over what was recorded of their
 * lips and jaw, asked what an engine's mouth says. Unlike the one that learns from the engine itself it gives
 * nothing for shapes that are merely kept apart: they have to be those of people. */
#ifndef FACCIA_EVAL_PERSON_READER_H
#define FACCIA_EVAL_PERSON_READER_H

#include "server/eval/person.h"

/* A mouth with its phones: of a person, or an engine. */
struct person_mouth {
    const struct speech_pack *pack;
    const struct phone_segments *segments;
    double (*at)(void *ctx, int measure, double t);
    void *ctx;
};

/* Adds a sample for each phone: the measures in `use` at its middle and at its neighbours' middles, as
 * deviations from the mean of this mouth over its phones in its standard deviations, so that neither the
 * place of a marker nor the size of a mouth counts; its class is its viseme group. */
void person_reader_add(struct lip_reader *reader, int half, const struct person_mouth *mouth,
                       const bool use[PERSON_MEASURES]);

#endif
