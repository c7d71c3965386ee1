/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hears one utterance of a listener: decodes the sound of a client, as of a live voice, and has its words
 * recognised. Nothing is stored. */
#ifndef FACCIA_LIVE_EAR_H
#define FACCIA_LIVE_EAR_H

#include "server/live/live_voice.h"
#include "server/live/recognition.h"

struct answers;
struct pipeline;

/* Shared by all ears. */
struct ear_pool {
    struct recogniser recogniser;
    struct answers *answers; /* words for choices on offer; NULL: none */
    unsigned most;           /* limit of ears */
    unsigned key_most;       /* limit per quota key (speech_request.h); 0 = none */
    unsigned seconds;        /* longest utterance */
    unsigned count;
    struct ear *ears; /* the open ones */
};

struct ear;

struct ear_calls {
    void (*words)(void *ctx, const struct heard_words *words); /* a preview */
    void (*warning)(void *ctx, const struct error *e);
    /* The sound, mono, RECOGNITION_RATE; count 0: it is complete. */
    void (*samples)(void *ctx, const int16_t *samples, size_t count);
    /* All words, or an error: "recogniser-failed", "bad-sound". Nothing follows; the owner frees the ear. */
    void (*done)(void *ctx, const struct heard_words *words, const struct error *e);
};

/* request: the format of the sound, and the room; of request->speech only `lang` and `quota_key` count.
 * Returns NULL with *e: "no-recogniser", "recogniser-failed", "too-many-voices", "unknown-codec",
 * "bad-field". */
struct ear *ear_open(const struct pipeline *pipeline, const struct live_request *request,
                     const struct ear_calls *calls, void *ctx, struct error *e);

/* Takes a message of the client: samples cut anywhere, or an Opus packet. After ear_pool.seconds of sound, or
 * of time, the utterance is closed with a warning "unfinished". */
void ear_sound(struct ear *ear, const uint8_t *bytes, size_t size);
void ear_close(struct ear *ear); /* the utterance is complete */
bool ear_is_open(const struct ear *ear);
void ear_free(struct ear *ear); /* NULL is ignored; no call follows */

#endif
