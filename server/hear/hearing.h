/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From anybody's voice to a face, while it speaks: sound goes in as it comes, frames of the face come out
 * once enough has been heard after their time. No text is known, and none can be had from it. Nothing is kept
 * but the sounds of the last seconds. */
#ifndef FACCIA_HEAR_HEARING_H
#define FACCIA_HEAR_HEARING_H

#include "server/hear/hear_face.h"
#include "server/hear/hear_network.h"

struct hearing_options {
    const struct hear_network *network; /* borrowed, as is all else */
    const struct speech_pack *pack;
    const char *engine; /* see hear_face_speaks */
    unsigned rate, channels;
    unsigned lookahead; /* ms: one that the network has a head for */
    double fps;
    bool lives; /* brows, lids, eyes and head follow the voice, too: see life_heard.h */
    /* The face at k / fps s of the sound. */
    void (*frame)(void *ctx, uint32_t k, const struct fap_frame *frame);
    /* A sound that has ended; may be NULL. */
    void (*phone)(void *ctx, const struct hear_phone *phone);
    void *ctx;
};

struct hearing;

/* NULL with *e: bad-sound, or bad-field (lookahead). */
struct hearing *hearing_new(const struct hearing_options *options, struct error *e);
void hearing_free(struct hearing *hearing);

/* See hear_sound_write. */
void hearing_write(struct hearing *hearing, const float *samples, size_t frames);

/* There is no more: the frames up to the end of the sound, and the last sound. */
void hearing_end(struct hearing *hearing);

/* s from a phone's frames. */
double hear_seconds(uint32_t frames);

#endif
