/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions on the face: the cues of a sentence, the mood, and how they blend with speech. */
#ifndef FACCIA_FACE_EXPRESSION_LAYER_H
#define FACCIA_FACE_EXPRESSION_LAYER_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/phone_segments.h"
#include "server/face/expression/cue_envelope.h"
#include "server/face/life/life.h"

/* Transition of expressions of the mouth, s; in pauses below twice that they stay off. */
#define ACTIVITY_RAMP 0.2

/* Share of the mouth that speech needs: 1 while speaking, 0 in pauses and outside the sentence. */
struct activity {
    struct activity_run {
        double rise, begin, end, fall; /* s: 0 at rise, 1 from begin to end, 0 at fall */
    } * runs;
    size_t count, cap;
};

struct sentence_expression {
    const struct expressions *expressions; /* a reference; NULL = no expressions */
    enum face_blend rule;
    struct cue_envelopes envelopes;
    struct activity activity;
};

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out);
void sentence_expression_free(struct sentence_expression *expression);

/* A single expression on a still face, for lists and pictures. */

/* Sets FAPs 2 to 68 to the entry's pose, with its gesture at the strongest key. intensity 0..1. */
void still_expression(const struct expressions *expressions, size_t index, double intensity,
                      struct fap_frame *frame);

/* Limit of simultaneous expressions; the latest are kept. Each gives way to later ones, and thousands over
 * one word would take longer than a frame. */
enum { EXPRESSIONS_AT_ONCE = 64 };

/* An expression at an instant. */
struct seen_expression {
    const struct expression *expression;
    double level;                    /* 0..1, including intensity */
    double omega;                    /* weight in the weighted rule */
    const struct cue_envelope *show; /* NULL = from the mood */
};

/* Expressions of one placement. */
struct expression_layer {
    const struct sentence_expression *sentence;
    double begin; /* of the sentence on the mood's clock, s */
    const struct mood *mood;
    size_t cursor, activity_cursor;
    /* cached for the last instant */
    double at; /* NAN = none yet */
    size_t seen_count;
    struct seen_expression seen[AFFECTS_MAX + EXPRESSIONS_AT_ONCE];
};

/* sentence = NULL: no speech. mood may be NULL and may change. Everything is borrowed. */
void expression_layer_begin(struct expression_layer *layer, const struct sentence_expression *sentence,
                            const struct mood *mood, double begin);

/* Blends the expressions at t into faps, which contain only speech, and sets *basic to FAP 2 for simple
 * decoders. demand: the contacts at t. */
void expression_layer_blend(struct expression_layer *layer, double t,
                            const struct contact_demand demand[CONTACT_TEETH + 1], double faps[FAP_COUNT + 1],
                            struct fap_expression *basic);

struct life_influence expression_layer_influence(struct expression_layer *layer);

#endif
