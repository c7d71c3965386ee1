/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A few words of a speech whose lips are plotted: the ones where most contacts lie close together. */
#ifndef FACCIA_EVAL_STRETCH_H
#define FACCIA_EVAL_STRETCH_H

#include "server/eval/eval.h"

enum { STRETCH_WORDS = 6, STRETCH_STEPS = 500, STRETCH_ENGINES = 16 };

/* Which words: begins zeroed. */
struct stretch_choice {
    size_t sentence, first, count; /* words [first, first + count) of that sentence of the speech */
    size_t contacts;
};

struct stretch_phone {
    char label[PHONE_NAME_BYTES]; /* IPA; "" = pause */
    double start, end;            /* s from the stretch's beginning */
};

struct stretch_span {
    double begin, end;
    bool teeth;
};

/* What is plotted of it at one speech rate. */
struct stretch {
    double seconds;
    struct stretch_phone *phones;
    size_t phone_count, phone_cap;
    struct stretch_span *spans; /* contacts */
    size_t span_count, span_cap;
    float gaps[STRETCH_ENGINES][STRETCH_STEPS + 1]; /* mm, evenly over the time */
};

/* Takes words of this sentence when they are better than those chosen so far; true when it did. */
bool stretch_choose(struct stretch_choice *choice, const struct speech_pack *pack,
                    const struct sentence_audio *u, size_t number);

/* Fills the stretch, once for each engine < STRETCH_ENGINES; in->audio is the one chosen, at any rate. */
void stretch_take(struct stretch *s, const struct stretch_choice *choice, const struct eval_input *in,
                  size_t engine);
void stretch_free(struct stretch *s);

#endif
