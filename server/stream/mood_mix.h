/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mood of a stream: the mixture of affects that was asked for last, on the stream's life clock, and on
 * the clocks of utterances that have their own. */
#ifndef FACCIA_STREAM_MOOD_MIX_H
#define FACCIA_STREAM_MOOD_MIX_H

#include "server/expression/expressions.h"

/* What is asked for, as mood_set takes it. Strings are borrowed. */
struct mood_request {
    const char *names[MOOD_MIX];
    double intensities[MOOD_MIX]; /* 0..1 */
    size_t count;
    double ease; /* s */
};

struct mood_mix {
    const struct expressions *expressions; /* NULL: there are none */
    struct mood *mood;                     /* on the stream's clock; NULL: there are no expressions */
    struct mood_request asked;             /* its names belong to the mix */
    double last;                           /* when, s of the stream's clock */
};

void mood_mix_open(struct mood_mix *mix, const struct expressions *expressions);
void mood_mix_close(struct mood_mix *mix);

/* From time `at` on. -1 with *e as mood_set; then nothing has changed. */
int mood_mix_set(struct mood_mix *mix, const struct mood_request *asked, double at, struct error *e);

/* The mood as asked last, on a clock that begins with it. The caller frees it. NULL: there are no
 * expressions. */
struct mood *mood_mix_copy(const struct mood_mix *mix);

/* Has a copy change as the mix was, at `at` of the copy's clock. */
void mood_mix_follow(const struct mood_mix *mix, struct mood *copy, double at);

#endif
