/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Media chunks as bytes, in the coding that a client has asked for. Where that takes long (Opus), it is done
 * in another thread, and the bytes come later, in the order of what was asked for. */
#ifndef FACCIA_CODEC_MEDIA_ENCODER_H
#define FACCIA_CODEC_MEDIA_ENCODER_H

#include "protocol/chunk.h"
#include "server/codec/codec_load.h"
#include "server/codec/encoding.h"

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
