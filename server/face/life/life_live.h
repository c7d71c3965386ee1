/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Movements of the upper face and the head for a live voice, from its sound alone: brows and nods with
 * prominent syllables, a nod and a blink at the end of a phrase, eyes aside at the beginning of a turn and
 * at the listener at its end, wider brows and lids for a livelier voice. Added to idle life; never affects
 * jaw, lips and tongue. */
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

/* Adds mono samples, -1..1, which wait for life_live_step. */
void life_live_write(struct life_live *life, const float *samples, size_t count);

/* Processes the next LIFE_LIVE_STEP samples; missing ones count as silence. */
void life_live_step(struct life_live *life);

/* Adds to the frame at t s, within the time processed: FAPs 19 to 26, 31 to 36 and 48 to 50. Call with
 * increasing t. While life controls the eyes, FAPs 23 to 26 are not in the frame's mask; their values keep
 * the gaze fixed while the head moves. */
void life_live_add(struct life_live *life, double t, struct fap_frame *frame);

#endif
