/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the sum of all layers to a frame: what flesh cannot do is taken back. */
#ifndef FACCIA_FACE_FACE_LIMITS_H
#define FACCIA_FACE_FACE_LIMITS_H

#include "protocol/fap.h"

struct speech_fapu;

/* Keeps lips and lids from passing through each other, rounds and limits; sets FAPs 3 to 68 of the frame. */
void face_limits_apply(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1], struct fap_frame *frame);

/* The FAPUs of a face that does not speak: those of the speakers on whom the languages were modelled. */
extern const struct speech_fapu *const face_idle_fapu;

#endif
