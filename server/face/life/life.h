/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The life layer: blinks, saccades and gaze, head motion tied to the speech's prosody, breathing, small
 * asymmetries. Depends only on the seed, the clock and the sentence, so it continues across the sentences of
 * a stream, and the same seed gives the same face.
 *
 * Guarantees:
 * - Outside its sentence (t <= 0, t >= the end) a layer has the values of a layer without a sentence at the
 *   same clock time. Idle face and sentences therefore join without a step, if seed, strength and influence
 *   agree.
 * - Samples may be taken in any order, with the same result. Forwards is cheapest; the cost of a sample does
 *   not depend on the length of the sentence or the clock.
 * - Lips and jaw part a little for a breath, only in pauses before speech. They return at least 80 ms before
 *   the next phone, so closures are unaffected. Mouth corners (FAPs 12, 13, 59, 60) are slightly uneven at
 *   rest, but not in speech. Otherwise FAPs 3 to 18, 37 to 47 and 51 to 60 are unchanged.
 * - Speed and acceleration of the head are bounded: its movements are smooth to the second derivative. */
#ifndef FACCIA_FACE_LIFE_LIFE_H
#define FACCIA_FACE_LIFE_LIFE_H

#include "server/expression/recipe.h"
#include "server/face/face_layer.h"
#include "server/face/track.h"
#include "server/voice/sentence_audio.h"

/* Effect of expressions on life at a time of the sentence; may be NULL. */
struct life_influence {
    void (*at)(void *ctx, double t, struct life_factors *out);
    void *ctx;
};

/* u = NULL: no sentence. options->begin: the sentence's start on the layer's clock, s. The clock's first
 * second fades in from the neutral face. options->life scales the movement of head, eyes (up to 1; a
 * quarter of it beyond), brows and breath, and the blink rate (up to 1; half of it beyond); 0 = no life. */
struct face_layer life_layer(const struct placement_options *options, const struct sentence_audio *u,
                             struct life_influence influence);

#endif
