/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How somebody wants to have the media. */
#ifndef FACCIA_CODEC_MEDIA_ENCODER_H
#define FACCIA_CODEC_MEDIA_ENCODER_H

#include "protocol/chunk.h"
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/codec/coder_pool.h"
#include "server/stream/stream.h"
#include <stdbool.h>
#include <stdint.h>

/* How one wants to have the media: Opus and FAPC in compact chunks, PCM and plain FAPs in those of version 1;
 * PCM also goes with FAPC. */
struct encoding {
    uint8_t audio;    /* enum chunk_audio, CHUNK_AUDIO_OPUS; CHUNK_AUDIO_SILENCE = none */
    uint8_t fap;      /* enum chunk_fap, CHUNK_FAP_FAPC; CHUNK_FAP_NONE = none */
    uint8_t kilobits; /* a second, of Opus; 0 = what suits the sound */
    bool packed;      /* what begins in a compact chunk is said in it: protocol/packed.h */
};

/* What protocol/README.md calls them: "opus", "pcm_s16le", "none"; "fapc", "plain", "none". -1 with *e
 * ("unknown-codec", with its field) when there is no such. */
int encoding_audio(const char *name, struct error *e);
int encoding_fap(const char *name, struct error *e);

/* Kilobits a second, 6 to 64. -1: no such. */
int encoding_kilobits(const char *number);

/* "packed": 1; "text": 0. -1: no such. */
int encoding_events(const char *name);

/* For those who do not say. */
extern const struct encoding encoding_default;
extern const struct encoding encoding_none; /* no media */

bool encoding_same(const struct encoding *a, const struct encoding *b);

/* Are events of that kind inside the chunks, and not messages of their own? */
bool encoding_packs(const struct encoding *encoding, enum stream_event_kind kind);

/* Do they go together? Plain FAPs are not coded beside Opus. */
bool encoding_possible(const struct encoding *encoding);

/* What turns chunks into bytes: the coders of one encoding, and where they have come. It belongs to one
 * thread at a time. */

/* How a chunk is to be coded. */
struct media_terms {
    bool begin;        /* a decoder can begin with it */
    unsigned level;    /* of the sound: codec_load.h */
    struct buf events; /* packed, which it says */
};

struct media_bytes {
    size_t audio, faps; /* faps: and all else */
};

struct media_coder;

/* Media chunks as bytes, in the coding that a client has asked for. Where that takes long (Opus), it is done
 * in another thread, and the bytes come later, in the order of what was asked for. */

enum {
    ENCODER_BEGIN_SECONDS = 10, /* at least so often one can begin */
};

/* What has become of one encoder_media or encoder_end. */
struct encoded {
    const uint8_t *data; /* the message, good during the call */
    size_t size;         /* 0: there is none */
    bool begin;          /* one can begin with it */
    size_t audio_bytes, fap_bytes;
};

/* On the loop, for each encoder_media and encoder_end with its tag, in their order; perhaps from within. Not
 * after encoder_free. */
typedef void encoder_done(void *ctx, void *tag, const struct encoded *encoded);

struct encoder;

/* One for all who get the same bytes. coders, codec_load: borrowed; how good the sound may be. NULL: it is
 * coded at once, and as good as can be. */
struct encoder *encoder_new(const struct encoding *encoding, struct coder_pool *coders,
                            struct codec_load *codec_load, encoder_done *done, void *ctx);
void encoder_free(struct encoder *encoder);

/* The next chunk that is asked for is one that a decoder can begin with. */
void encoder_restart(struct encoder *encoder);

/* Has the next chunk say the event; of an encoding that packs its kind. */
void encoder_event(struct encoder *encoder, const struct stream_event *event);

/* Codes them. */
void encoder_media(struct encoder *encoder, const struct media *media, void *tag);

/* The utterance has ended. heard: to its end; then there may be a message with what the audio coder still
 * held. If not, what is not coded yet is left out. */
void encoder_end(struct encoder *encoder, bool heard, void *tag);

#endif
