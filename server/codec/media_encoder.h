/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Media chunks as bytes, in the coding that a client has asked for. */
#ifndef FACCIA_CODEC_MEDIA_ENCODER_H
#define FACCIA_CODEC_MEDIA_ENCODER_H

#include "protocol/compact.h"
#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/codec/codec_load.h"
#include "server/stream/stream.h"

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

/* For clients that name none. */
extern const struct encoding encoding_default;
extern const struct encoding encoding_none; /* no media */

bool encoding_same(const struct encoding *a, const struct encoding *b);

/* Are events of that kind inside the chunks, and not messages of their own? */
bool encoding_packs(const struct encoding *encoding, enum stream_event_kind kind);

/* Do they go together? Plain FAPs are not coded beside Opus. */
bool encoding_possible(const struct encoding *encoding);

struct encoder;

enum {
    ENCODER_BEGIN_SECONDS = 10, /* at least so often one can begin */
};

/* One for all who get the same bytes. codec_load: borrowed, how good the sound may be; NULL = as can be. */
struct encoder *encoder_new(const struct encoding *encoding, struct codec_load *codec_load);
void encoder_free(struct encoder *encoder);

/* The next chunk that is written is one that a decoder can begin with. */
void encoder_restart(struct encoder *encoder);

/* Has the next chunk say the event; of an encoding that packs its kind. */
void encoder_event(struct encoder *encoder, const struct stream_event *event);

struct encoded {
    bool begin; /* one can begin with it */
    size_t audio_bytes, fap_bytes;
};

/* Appends the message that carries the media. */
struct encoded encoder_media(struct encoder *encoder, const struct media *media, struct buf *out);

/* The utterance has ended. heard: to its end; then a message with what the audio coder still holds is
 * appended, if that is anything. */
void encoder_end(struct encoder *encoder, bool heard, struct buf *out);

#endif
