/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions on the face: the cues of a sentence and the mood, blended with the speech under them. */
#ifndef FACCIA_FACE_EXPRESSION_EXPRESSION_LAYER_H
#define FACCIA_FACE_EXPRESSION_EXPRESSION_LAYER_H

#include "server/face/engines/contact.h"
#include "server/face/expression/activity.h"
#include "server/face/expression/cue_envelope.h"
#include "server/face/life/life.h"

struct expression_layer;

/* u and g = NULL: nobody speaks. NULL when there is nothing to express with. */
struct expression_layer *expression_layer_new(const struct sentence_audio *u, const struct phone_segments *g,
                                              const struct face_options *options);
void expression_layer_free(struct expression_layer *express);

/* Blends the expressions at t into faps, which hold the speech and nothing else, and says in *basic what a
 * decoder that knows FAP 2 alone is to show. demand: the contacts at t. */
void expression_layer_blend(struct expression_layer *express, double t,
                            const struct contact_demand demand[CONTACT_TEETH + 1], double faps[FAP_COUNT + 1],
                            struct fap_expression *basic);

struct life_influence expression_layer_influence(struct expression_layer *express);

#endif
