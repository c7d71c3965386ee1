/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes when a cue of a sentence is visible and how strongly, and blends expressions with speech. Values
 * are reals in FAP units. */
#ifndef FACCIA_FACE_CUE_ENVELOPE_H
#define FACCIA_FACE_CUE_ENVELOPE_H

#include "server/expression/recipe.h"
#include "server/face/track.h"
#include "server/voice/sentence_audio.h"

/* Minimum rise and fall time of an expression, s; shorter settings are raised to it. At intensity i a FAP
 * moves at most 1.5 i / CUE_FASTEST of its value per second (smooth rise) per expression and end; a frame at
 * 25 fps sees at most 60 % of it. */
#define CUE_FASTEST 0.1

/* A cue on the face. Its pose is 0 until begin, complete at full, and falls from fall to 0 at end. */
struct cue_envelope {
    const struct expression *expression;
    double intensity, weight; /* weight: omega at intensity 1 */
    double from, to;          /* the stretch of speech, s */
    double begin, full, fall, end;
    bool is_affect;
    bool straight;                 /* linear rise and fall, as in the weighted rule */
    double settle_from, settle_to; /* falls from 1 to the envelope's sustain */
    double gesture, pace, reach;   /* its gesture: s at key time 0, s per second of keys, size 0..1 */
    size_t order;                  /* of the cue in the sentence */
    double first, last;            /* visible only within these times */
};

/* All cues of a sentence, sorted by `first`. Expressions that continue in the next sentence are held at
 * their sustained level across the boundary; all others end with the sentence, within the pause after the
 * last word if that is long enough. So faces join, and each sentence depends only on itself. (Utterances
 * shorter than CUE_FASTEST are too short for that.) */
struct cue_envelopes {
    struct cue_envelope *items;
    double *latest; /* latest[i]: maximum of `last` up to item i */
    size_t count;
};

void cue_envelopes_from(const struct sentence_audio *u, const struct expressions *expressions,
                        enum face_blend blend, struct cue_envelopes *out);

/* Keeps only the poses of affects: a face that keeps still has a mood, but no accents and no gestures. */
void cue_envelopes_calm(struct cue_envelopes *shows);
void cue_envelopes_free(struct cue_envelopes *shows);

/* Returns the pose's level at t without the cue's intensity, 0..1. */
double cue_envelope_level(const struct cue_envelope *show, double t);

/* Finds the gesture's position at t: the first of two keys, and the fraction towards the second, 0..1.
 * Returns false if no gesture is shown at t. */
bool cue_envelope_gesture(const struct cue_envelope *show, double t, size_t *key, double *on);

/* Blending at an instant. Call in this order: blend_speech; blend_add and blend_add_weighted for all
 * expressions; blend_join. */
struct blend {
    enum face_blend rule;
    double activity;             /* of speech, 0..1: expression_layer.h */
    double contact;              /* demand of the strongest contact, 0..1 */
    double *face;                /* FAPs: the speech, to which expressions are added */
    double mouth[FAP_COUNT + 1]; /* the expressions' part in it, until blend_join */
};

/* Scales the speech by `articulation`, and to make room for emotions by 1 - omega, where omega is the sum of
 * their weights (0 in BLEND_REGIONS): eq. 5.3 and 5.4 as displacements, (1 - omega) speech + omega rho
 * emotion. */
void blend_speech(const struct blend *blend, double articulation, double omega);

/* Adds w times a pose. `mouth` is the share that stays where it overlaps with speech. */
void blend_add(struct blend *blend, const struct pose *pose, double w, struct mouth_share mouth);

/* Adds an emotion with weight omega by the rule of E. Akagunduz 2004: the empowered expression N + rho (E -
 * N), eq. 5.2. */
void blend_add_weighted(struct blend *blend, const struct pose *pose, double omega);

void blend_join(const struct blend *blend);

/* Share of an expression visible at rest in that rule: rho omega. */
double blend_shown(double omega);

/* FAP 2: the two strongest of the six. */
struct fap_expression blend_basics(const double shares[BASIC_COUNT + 1]);

#endif
