/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the upper face and the head do with a voice that is heard while it speaks, from its sound alone: brows
 * and nods with syllables that stand out, a nod and a blink where a phrase ends, the eyes aside at the
 * beginning of a turn and at the listener at its end, brows and lids wider the livelier the voice is. It adds
 * to life, which goes on as while nobody speaks; jaw, lips and tongue it never touches. */
#ifndef FACCIA_FACE_LIFE_LIFE_HEARD_H
#define FACCIA_FACE_LIFE_LIFE_HEARD_H

#include "protocol/fap.h"
#include <stddef.h>

enum { LIFE_HEARD_RATE = 16000, LIFE_HEARD_STEP = 160 /* samples */ };

struct life_heard;

struct life_heard *life_heard_new(void);
void life_heard_free(struct life_heard *life);

/* Samples of one channel, -1..1, which wait until a step takes them. */
void life_heard_write(struct life_heard *life, const float *samples, size_t count);

/* Hears the next LIFE_HEARD_STEP of them; what is lacking is silence. */
void life_heard_step(struct life_heard *life);

/* The frame at t s, of the time that has been heard: adds to FAPs 19 to 26, 31 to 36 and 48 to 50. Times do
 * not go backwards. Where the eyes are life's to move, FAPs 23 to 26 are not in the frame's mask; what they
 * have keeps them where they look while the head moves. */
void life_heard_add(struct life_heard *life, double t, struct fap_frame *frame);

#endif
