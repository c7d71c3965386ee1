/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sentence expresses: its cues, and how much of the mouth speech needs. Immutable. */
#ifndef FACCIA_FACE_EXPRESSION_LAYER_H
#define FACCIA_FACE_EXPRESSION_LAYER_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/phone_segments.h"
#include "server/face/expression/cue_envelope.h"
#include "server/face/life/life.h"

/* An expression of the mouth comes and goes within this time, s; in pauses under twice that it stays away. */
#define ACTIVITY_RAMP 0.2

/* How much of the mouth speech needs: 1 while she speaks, 0 in pauses and outside of the sentence. */
struct activity {
    struct activity_run {
        double rise, begin, end, fall; /* s: 0 at rise, 1 from begin to end, 0 at fall */
    } * runs;
    size_t count, cap;
};

struct sentence_expression {
    const struct expressions *expressions; /* a share; NULL: there are none to show cues with */
    enum face_blend rule;
    struct cue_envelopes envelopes;
    struct activity activity;
};

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out);
void sentence_expression_free(struct sentence_expression *expression);

/* One expression alone on a face that neither speaks nor lives, for lists and pictures. */

/* The entry with that index, its pose held and its gesture at the strongest key. intensity 0..1. Sets FAPs 2
 * to 68. */
void still_expression(const struct expressions *expressions, size_t index, double intensity,
                      struct fap_frame *frame);

/* The expressions on the face: the cues of a sentence and the mood, blended with the speech under them. */

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
