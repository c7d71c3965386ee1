/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expressions on the face: the cues of an utterance and the mood, blended with the speech under them. */
#ifndef FACCIA_FACE_EXPRESS_H
#define FACCIA_FACE_EXPRESS_H

#include "server/face/activity.h"
#include "server/face/contact.h"
#include "server/face/life.h"
#include "server/face/show.h"

struct express;

/* u and g = NULL: nobody speaks. NULL when there is nothing to express with. */
struct express *express_new(const struct utterance *u, const struct gestures *g,
                            const struct face_options *options);
void express_free(struct express *express);

/* Blends the expressions at t into faps, which hold the speech and nothing else, and says in *basic what a
 * decoder that knows FAP 2 alone is to show. demand: the contacts at t. */
void express_blend(struct express *express, double t, const struct contact_demand demand[CONTACT_TEETH + 1],
                   double faps[FAP_COUNT + 1], struct fap_expression *basic);

struct life_influence express_influence(struct express *express);

#endif
