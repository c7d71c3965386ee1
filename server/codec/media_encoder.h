/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes media chunks in the encoding that a client chose: Opus and FAPC in compact chunks, PCM and plain
 * FAPs in those of version 1; PCM may be combined with FAPC. Expensive coding (Opus) runs on another
 * thread; its results come later, in order. */
#ifndef FACCIA_CODEC_MEDIA_ENCODER_H
#define FACCIA_CODEC_MEDIA_ENCODER_H

#include "protocol/chunk/chunk.h"
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/codec/coder_pool.h"
#include "server/stream/stream.h"
#include <stdbool.h>
#include <stdint.h>

/* A client's choice of encoding. */
struct encoding {
    uint8_t audio;    /* enum chunk_audio, CHUNK_AUDIO_OPUS; CHUNK_AUDIO_SILENCE = none */
    uint8_t fap;      /* enum chunk_fap, CHUNK_FAP_FAPC; CHUNK_FAP_NONE = none */
    uint8_t kilobits; /* bit rate of Opus, kbit/s; 0 = default for the sound */
    bool packed;      /* compact chunks carry their events: protocol/chunk/packed.h */
};

/* Parse the names of protocol/README.md: "opus", "pcm_s16le", "none"; "fapc", "plain", "none". Return -1
 * with *e ("unknown-codec", with its field). */
int encoding_audio(const char *name, struct error *e);
int encoding_fap(const char *name, struct error *e);

/* kbit/s, 6 to 64, else -1. */
int encoding_kilobits(const char *number);

/* "packed": 1; "text": 0; else -1. */
int encoding_events(const char *name);

/* For clients that do not choose. */
extern const struct encoding encoding_default;
extern const struct encoding encoding_none; /* no media */

bool encoding_same(const struct encoding *a, const struct encoding *b);

/* Tells whether events of that kind are inside chunks instead of separate messages. */
bool encoding_packs(const struct encoding *encoding, enum stream_event_kind kind);

/* Tells whether the combination is supported: plain FAPs are not coded beside Opus. */
bool encoding_possible(const struct encoding *encoding);

/* The coders of one encoding with their state. Used by one thread at a time. */

/* Parameters for one chunk. */
struct media_terms {
    bool begin;        /* decoders can start here */
    unsigned level;    /* quality of the sound: coder_pool.h */
    struct buf events; /* packed events to include */
};

struct media_bytes {
    size_t audio, faps; /* faps: everything else */
};

struct media_coder;

enum {
    ENCODER_BEGIN_SECONDS = 10, /* maximum interval between starting points */
};

/* Result of one encoder_media or encoder_end. */
struct encoded {
    const uint8_t *data; /* the message, valid during the call */
    size_t size;         /* 0 = no message */
    bool begin;          /* decoders can start here */
    size_t audio_bytes, fap_bytes;
};

/* Called on the loop for each encoder_media and encoder_end with its tag, in order, possibly within the
 * call. Not after encoder_free. */
typedef void encoder_done(void *ctx, void *tag, const struct encoded *encoded);

struct encoder;

/* One encoder serves all clients that get the same bytes. coders and codec_load are borrowed; NULL = code
 * at once, in best quality. */
struct encoder *encoder_new(const struct encoding *encoding, struct coder_pool *coders,
                            struct codec_load *codec_load, encoder_done *done, void *ctx);
void encoder_free(struct encoder *encoder);

/* Makes the next chunk a starting point for decoders. */
void encoder_restart(struct encoder *encoder);

/* Adds an event to the next chunk, if the encoding packs its kind. */
void encoder_event(struct encoder *encoder, const struct stream_event *event);

void encoder_media(struct encoder *encoder, const struct media *media, void *tag);

/* Ends the utterance. If heard to its end, there may be a message with remaining sound; otherwise sound
 * not yet coded is dropped. */
void encoder_end(struct encoder *encoder, bool heard, void *tag);

#endif
