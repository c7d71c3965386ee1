/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From how likely each class is, frame by frame, to sounds with their times. A closure that is missed is
 * worse than one too many: it begins as soon as it is likely, and holds until it is not. */
#ifndef FACCIA_HEAR_LIP_RECOGNISER_H
#define FACCIA_HEAR_LIP_RECOGNISER_H

#include "protocol/fap.h"
#include "server/face/packs/shape_table.h"
#include "server/face/packs/speech_pack.h"
#include "server/hear/lip_network.h"
#include <stdbool.h>
#include <stdint.h>

/* Frame k is the 10 ms around the middle of the window that it was made of, which begin k frames after this.
 */
#define LIP_FIRST_SECONDS 0.0075
enum { LIP_FRAMES_A_SECOND = 100 };

struct lip_phone {
    enum lip_class class;
    uint32_t start, end;        /* it ends where the next begins */
    double likely[LIP_CLASSES]; /* sums over its frames of how likely each class was */
};

struct lip_decoder {
    struct lip_phone now; /* end = what has been heard so far */
    enum lip_class next;  /* may be about to begin */
    uint32_t since;       /* from that frame on; nothing is when this is now.end */
    double next_likely[LIP_CLASSES], before[LIP_CLASSES]; /* over its frames; over now's before it */
};

void lip_decoder_begin(struct lip_decoder *decoder);

/* Takes the next frame. True: a phone has ended, which is in *ended. */
bool lip_decoder_step(struct lip_decoder *decoder, const float likely[LIP_CLASSES], struct lip_phone *ended);

/* The face of what is being heard: the mouth that the network tells, or that of an engine over the sounds of
 * the last seconds; what is yet to come is not known, so an engine does not prepare for it. Contacts and
 * openings are those of these sounds, as with a text. */

/* So many sounds at most, none that ended longer ago: frames. */
enum { LIP_FACE_PHONES = 64, LIP_FACE_REACH = 200 };

struct lip_face {
    const struct speech_pack *pack; /* borrowed */
    const char *engine;             /* NULL: the network's mouth; borrowed */
    struct lip_phone phones[LIP_FACE_PHONES];
    size_t count;
};

/* The name that the network's own mouth has among the engines. */
#define LIP_ENGINE "network"

/* Whether the face can be made so: by an engine that speaks the pack, or by the network (NULL or its name).
 */
bool lip_face_speaks(const char *engine, const struct speech_pack *pack);

/* Whether anybody speaks, or it is music or noise: evidence adds up, so that a doubtful moment changes
 * nothing. In silence it stays as it is. */

struct lip_voice {
    float evidence;
    bool none; /* nobody speaks */
};

void lip_voice_begin(struct lip_voice *voice);

/* Takes the next frame: how likely a voice is (the logarithm of the odds), and how likely silence. */
void lip_voice_step(struct lip_voice *voice, float odds, float silence);

/* From anybody's voice to a face, while it speaks: sound goes in as it comes, frames of the face come out
 * once enough has been heard after their time. No text is known, and none can be had from it. Nothing is kept
 * but the sounds of the last seconds. */

struct lip_recogniser_options {
    const struct lip_network *network; /* borrowed, as is all else */
    const struct speech_pack *pack;
    const char *engine; /* see lip_face_speaks */
    unsigned rate, channels;
    unsigned lookahead; /* ms: one that the network has a head for */
    double fps;
    bool lives; /* brows, lids, eyes and head follow the voice, too: see life_live.h */
    /* The face at k / fps s of the sound. */
    void (*frame)(void *ctx, uint32_t k, const struct fap_frame *frame);
    /* A sound that has ended; may be NULL. */
    void (*phone)(void *ctx, const struct lip_phone *phone);
    void *ctx;
};

struct lip_recogniser;

/* NULL with *e: bad-sound, or bad-field (lookahead). */
struct lip_recogniser *lip_recogniser_new(const struct lip_recogniser_options *options, struct error *e);
void lip_recogniser_free(struct lip_recogniser *recogniser);

/* See lip_input_write. */
void lip_recogniser_write(struct lip_recogniser *recogniser, const float *samples, size_t frames);

/* There is no more: the frames up to the end of the sound, and the last sound. */
void lip_recogniser_end(struct lip_recogniser *recogniser);

/* s from a phone's frames. */
double hear_seconds(uint32_t frames);

#endif
