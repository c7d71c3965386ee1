/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two rules by which expressions and speech share a face. Values are reals in FAP units. */
#ifndef FACCIA_FACE_BLEND_H
#define FACCIA_FACE_BLEND_H

#include "server/expression/recipe.h"
#include "server/face/track.h"

/* What is to be blended at an instant. */
struct blend {
    enum face_blend rule;
    double activity;            /* of speech, 0..1: activity.h */
    double contact;             /* demand of the strongest contact, 0..1 */
    double articulation;        /* factor of the speech's movements */
    double omega;               /* sum of the emotions' weights; BLEND_WEIGHTED only */
    double faps[FAP_COUNT + 1]; /* what blend_add added */
};

/* Adds w times a pose. Where it shares the mouth with speech, `mouth` says how much of it stays. */
void blend_add(struct blend *blend, const struct pose *pose, double w, struct mouth_share mouth);

/* Adds an emotion with weight omega by the rule of E. Akagunduz 2004: the empowered expression N + rho (E -
 * N), eq. 5.2. */
void blend_add_weighted(struct blend *blend, const struct pose *pose, double omega);

/* How much of an expression that rule shows at rest: rho omega. */
double blend_shown(double omega);

/* Joins what was added with the speech in faps. Once for each blend. */
void blend_join(struct blend *blend, double faps[FAP_COUNT + 1]);

/* FAP 2: the two strongest of the six. */
struct fap_expression blend_basics(const double shares[BASIC_COUNT + 1]);

#endif
