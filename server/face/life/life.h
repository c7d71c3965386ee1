/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The life layer: blinks, saccades and gaze, head motion tied to the speech's prosody, breathing, small
 * asymmetries. A function of the seed, the clock and the sentence alone, so it runs on over the sentences
 * of a stream and the same seed gives the same face.
 *
 * What is guaranteed:
 * - Outside its sentence (t <= 0, t >= the end) a layer's values are those of a layer without a sentence
 * at the same time of the clock. So idle face, sentence, the next one, idle face join without a step,
 * whatever the sentences are. (The influence has to agree, too, and so do seed and strength.)
 * - It may be sampled in any order, with the same values; forwards it is cheapest, and each sample costs the
 *   same, however long the sentence and the clock are.
 * - Lips and jaw part a little for a breath, in pauses before speech alone: at least 80 ms before the next
 *   phone they are where speech put them, so that no closure is touched. Mouth corners (FAPs 12, 13, 59, 60)
 *   are slightly uneven at rest, and that goes away in speech. Otherwise FAPs 3 to 18, 37 to 47 and 51 to 60
 *   are left alone.
 * - Speed and acceleration of the head are bounded: all its ways are smooth to the second derivative. */
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

/* u = NULL: nobody speaks. options->begin: the sentence's start on the layer's clock, s. The clock's first
 * second fades in from the neutral face. options->life scales the movement of head, eyes (up to 1; a
 * quarter of it beyond), brows and breath, and the blink rate (up to 1; half of it beyond); 0 = no life. */
struct face_layer life_layer(const struct placement_options *options, const struct sentence_audio *u,
                             struct life_influence influence);

#endif
