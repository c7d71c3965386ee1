/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When a cue of a sentence is to be seen, and how strongly. */
#ifndef FACCIA_FACE_CUE_ENVELOPE_H
#define FACCIA_FACE_CUE_ENVELOPE_H

#include "server/expression/recipe.h"
#include "server/face/track.h"
#include "server/voice/sentence_audio.h"

/* However an author sets onset and offset, an expression rises and falls in no less than this, s. So at
 * intensity i, of one expression, a FAP moves at most 1.5 i / CUE_FASTEST of its value in the recipe in a
 * second (smooth rise) for each end; a frame of 25 a second sees at most 60 % of it. */
#define CUE_FASTEST 0.1

/* One cue on the face. Its pose is 0 up to begin, full at full, and goes from fall to 0 at end. */
struct cue_envelope {
    const struct expression *expression;
    double intensity, weight; /* weight: omega at intensity 1 */
    double from, to;          /* the stretch of speech, s */
    double begin, full, fall, end;
    bool is_affect;
    bool straight;                 /* rises and falls in straight lines, as the weighted rule does */
    double settle_from, settle_to; /* from 1 to the curve's sustain */
    double gesture, pace, reach;   /* its gesture: s at key time 0, s for each of its seconds, size 0..1 */
    size_t order;                  /* of the cue in the sentence */
    double first, last;            /* nothing is to be seen outside of these times */
};

/* All cues of a sentence, sorted by `first`. Expressions that go on in the next sentence are held at the
 * sentence's end at their sustained level, as they are at the next one's beginning; all others have gone
 * when it ends, within the pause after the last word if that is long enough. So the faces join, and each
 * sentence is a function of itself alone. (Utterances that last under CUE_FASTEST are too short for that.)
 */
struct cue_envelopes {
    struct cue_envelope *items;
    double *latest; /* latest[i]: of the items up to i the latest `last` */
    size_t count;
};

void cue_envelopes_from(const struct sentence_audio *u, const struct expressions *expressions,
                        enum face_blend blend, struct cue_envelopes *out);
void cue_envelopes_free(struct cue_envelopes *shows);

/* The intensity of the pose at t without the cue's own intensity, 0..1. */
double cue_envelope_level(const struct cue_envelope *show, double t);

/* The gesture at t: between which keys, and how far on from the first to the second, 0..1. False when
 * there is none at that time. */
bool cue_envelope_gesture(const struct cue_envelope *show, double t, size_t *key, double *on);

/* The two rules by which expressions and speech share a face. Values are reals in FAP units. */

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
