/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the upper face and the head do with a voice that is heard while it speaks, from its sound alone: brows
 * and nods with syllables that stand out, a nod and a blink where a phrase ends, the eyes aside at the
 * beginning of a turn and at the listener at its end, brows and lids wider the livelier the voice is. It adds
 * to life, which goes on as while nobody speaks; jaw, lips and tongue it never touches. */
#ifndef FACCIA_FACE_LIFE_LIVE_H
#define FACCIA_FACE_LIFE_LIVE_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LIFE_LIVE_RATE = 16000, LIFE_LIVE_STEP = 160 /* samples */ };

struct life_live;

struct life_live *life_live_new(void);
void life_live_free(struct life_live *life);

/* Samples of one channel, -1..1, which wait until a step takes them. */
void life_live_write(struct life_live *life, const float *samples, size_t count);

/* Hears the next LIFE_LIVE_STEP of them; what is lacking is silence. */
void life_live_step(struct life_live *life);

/* The frame at t s, of the time that has been heard: adds to FAPs 19 to 26, 31 to 36 and 48 to 50. Times do
 * not go backwards. Where the eyes are life's to move, FAPs 23 to 26 are not in the frame's mask; what they
 * have keeps them where they look while the head moves. */
void life_live_add(struct life_live *life, double t, struct fap_frame *frame);

#endif
