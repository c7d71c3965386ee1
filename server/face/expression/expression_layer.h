/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions on the face: the cues of a sentence and the mood, blended with the speech under them. */
#ifndef FACCIA_FACE_EXPRESSION_EXPRESSION_LAYER_H
#define FACCIA_FACE_EXPRESSION_EXPRESSION_LAYER_H

#include "server/expression/recipe.h"
#include "server/face/engines/contact.h"
#include "server/face/expression/sentence_expression.h"
#include "server/face/life/life.h"

/* Of more expressions at a time than any author means, those that came last count. Each gives way to those
 * after it: thousands of them over one word would take longer than the frame lasts. */
enum { EXPRESSIONS_AT_ONCE = 64 };

/* An expression at an instant. */
struct seen_expression {
    const struct expression *expression;
    double level;                    /* 0..1, intensity included */
    double omega;                    /* in the weighted rule */
    const struct cue_envelope *show; /* NULL: of the mood */
};

/* One placement's view of the expressions. */
struct expression_layer {
    const struct sentence_expression *sentence;
    double begin; /* of the sentence on the clock of the mood, s */
    const struct mood *mood;
    size_t cursor, activity_cursor;
    /* what was seen last */
    double at; /* NAN: nothing yet */
    size_t seen_count;
    struct seen_expression seen[AFFECTS_MAX + EXPRESSIONS_AT_ONCE];
};

/* sentence = NULL: nobody speaks. mood may be NULL, and may change. All is borrowed. */
void expression_layer_begin(struct expression_layer *layer, const struct sentence_expression *sentence,
                            const struct mood *mood, double begin);

/* Blends the expressions at t into faps, which hold the speech and nothing else, and says in *basic what a
 * decoder that knows FAP 2 alone is to show. demand: the contacts at t. */
void expression_layer_blend(struct expression_layer *layer, double t,
                            const struct contact_demand demand[CONTACT_TEETH + 1], double faps[FAP_COUNT + 1],
                            struct fap_expression *basic);

struct life_influence expression_layer_influence(struct expression_layer *layer);

#endif
