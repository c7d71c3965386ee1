/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognises mouth movements from sound as it arrives. The decoder turns class probabilities into phones
 * with times; because a missed closure is worse than a false one, a closure starts as soon as it is likely
 * and holds until it is not. */
#ifndef FACCIA_LIVE_LIP_RECOGNISER_H
#define FACCIA_LIVE_LIP_RECOGNISER_H

#include "protocol/fap.h"
#include "server/face/packs/shape_table.h"
#include "server/face/packs/speech_pack.h"
#include "server/live/lip_network.h"
#include <stdbool.h>
#include <stdint.h>

/* Frame k is the 10 ms around the middle of its window, starting k frames after this. */
#define LIP_FIRST_SECONDS 0.0075
enum { LIP_FRAMES_A_SECOND = 100 };

struct lip_phone {
    enum lip_class class;
    uint32_t start, end;        /* end is the start of the next */
    double likely[LIP_CLASSES]; /* sums of the class probabilities over its frames */
};

struct lip_decoder {
    struct lip_phone now; /* end = frames heard so far */
    enum lip_class next;  /* candidate for the next phone */
    uint32_t since;       /* its first frame; equal to now.end if there is no candidate */
    double next_likely[LIP_CLASSES],
        before[LIP_CLASSES]; /* over its frames; over the frames of `now` before it */
};

void lip_decoder_begin(struct lip_decoder *decoder);

/* Processes the next frame. Returns true when a phone has ended, in *ended. */
bool lip_decoder_step(struct lip_decoder *decoder, const float likely[LIP_CLASSES], struct lip_phone *ended);

/* The face for the recognised sounds: the network's mouth, or an engine's for the last seconds of phones.
 * Later sounds are unknown, so an engine cannot anticipate them. Contacts and openings follow the phones,
 * as with a text. */

/* Limits of remembered phones: number, and age in frames. */
enum { LIP_FACE_PHONES = 64, LIP_FACE_REACH = 200 };

struct lip_face {
    const struct speech_pack *pack; /* borrowed */
    const char *engine;             /* NULL = the network's mouth; borrowed */
    struct lip_phone phones[LIP_FACE_PHONES];
    size_t count;
};

/* The network's mouth as an engine name. */
#define LIP_ENGINE "network"

/* Tells whether the face can be made by that engine for the pack, or by the network (NULL or its name). */
bool lip_face_speaks(const char *engine, const struct speech_pack *pack);

/* Decides between voice and music or noise by accumulated evidence. Silence does not change the decision. */

struct lip_voice {
    float evidence;
    bool none; /* not a voice */
};

void lip_voice_begin(struct lip_voice *voice);

/* Processes the log odds of a voice and the probability of silence in a frame. */
void lip_voice_step(struct lip_voice *voice, float odds, float silence);

/* Turns sound into face frames with a fixed delay. There is no text and no transcript; only the phones of
 * the last seconds are kept. */

struct lip_recogniser_options {
    const struct lip_network *network; /* borrowed, like the other pointers */
    const struct speech_pack *pack;
    const char *engine; /* see lip_face_speaks */
    unsigned rate, channels;
    unsigned lookahead; /* ms; the network must have a head for it */
    double fps;
    bool lives; /* brows, lids, eyes and head follow the voice: see life_live.h */
    /* The face at k / fps s of the sound. */
    void (*frame)(void *ctx, uint32_t k, const struct fap_frame *frame);
    /* A finished phone; may be NULL. */
    void (*phone)(void *ctx, const struct lip_phone *phone);
    void *ctx;
};

struct lip_recogniser;

/* Returns NULL with *e: bad-sound, or bad-field (lookahead). */
struct lip_recogniser *lip_recogniser_new(const struct lip_recogniser_options *options, struct error *e);
void lip_recogniser_free(struct lip_recogniser *recogniser);

/* See lip_input_write. */
void lip_recogniser_write(struct lip_recogniser *recogniser, const float *samples, size_t frames);

/* Ends the sound: emits the remaining frames and the last phone. */
void lip_recogniser_end(struct lip_recogniser *recogniser);

/* Converts a phone's frames to s. */
double hear_seconds(uint32_t frames);

#endif
