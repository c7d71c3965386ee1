/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face of what is being heard: the same engines, contacts and openings as with a text, over the sounds of
 * the last seconds. What is yet to come is not known, so the mouth does not prepare for it. */
#ifndef FACCIA_HEAR_HEAR_FACE_H
#define FACCIA_HEAR_HEAR_FACE_H

#include "protocol/fap.h"
#include "server/face/packs/speech_pack.h"
#include "server/hear/hear_decoder.h"

/* So many sounds at most, none that ended longer ago: frames. */
enum { HEAR_FACE_PHONES = 64, HEAR_FACE_REACH = 200 };

struct hear_face {
    const struct speech_pack *pack; /* borrowed */
    const char *engine;             /* NULL = the default one; borrowed */
    struct hear_phone phones[HEAR_FACE_PHONES];
    size_t count;
};

/* A phone that has ended. */
void hear_face_add(struct hear_face *face, const struct hear_phone *phone);

/* The mouth at t s, while `now` is being heard. */
void hear_face_sample(struct hear_face *face, const struct hear_phone *now, double t,
                      struct fap_frame *frame);

#endif
