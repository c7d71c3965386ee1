/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two rules by which expressions and speech share a face. Values are reals in FAP units. */
#ifndef FACCIA_FACE_EXPRESSION_BLEND_H
#define FACCIA_FACE_EXPRESSION_BLEND_H

#include "server/expression/recipe.h"
#include "server/face/face_options.h"

/* What is to be blended at an instant. To be used in this order: blend_speech, blend_add and
 * blend_add_weighted for all there is, blend_join. */
struct blend {
    enum face_blend rule;
    double activity;             /* of speech, 0..1: sentence_expression.h */
    double contact;              /* demand of the strongest contact, 0..1 */
    double *face;                /* FAPs: the speech, to which the rest is added */
    double mouth[FAP_COUNT + 1]; /* the expressions' part in it, until they are joined */
};

/* Scales the speech: articulation is a factor of its movements, omega (0 in BLEND_REGIONS) the sum of the
 * emotions' weights, by which it gives way to them: eq. 5.3 and 5.4 as displacements, (1 - omega) speech +
 * omega rho emotion. */
void blend_speech(const struct blend *blend, double articulation, double omega);

/* Adds w times a pose. Where it shares the mouth with speech, `mouth` says how much of it stays. */
void blend_add(struct blend *blend, const struct pose *pose, double w, struct mouth_share mouth);

/* Adds an emotion with weight omega by the rule of E. Akagunduz 2004: the empowered expression N + rho (E -
 * N), eq. 5.2. */
void blend_add_weighted(struct blend *blend, const struct pose *pose, double omega);

void blend_join(const struct blend *blend);

/* How much of an expression that rule shows at rest: rho omega. */
double blend_shown(double omega);

/* FAP 2: the two strongest of the six. */
struct fap_expression blend_basics(const double shares[BASIC_COUNT + 1]);

#endif
