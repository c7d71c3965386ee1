/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Media chunks as bytes, in the coding that a client has asked for. */
#ifndef FACCIA_STREAM_ENCODE_H
#define FACCIA_STREAM_ENCODE_H

#include "protocol/chunk.h"
#include "server/base/buf.h"
#include <stdbool.h>

/* How one wants to have the media. */
struct encoding {
    uint8_t audio; /* enum chunk_audio */
    uint8_t fap;   /* enum chunk_fap */
};

/* What protocol/README.md calls it: "opus", "pcm_s16le", "none"; "fba", "plain", "none". -1: no such. */
int encoding_audio(const char *name);
int encoding_fap(const char *name);

/* For those who do not say. */
extern const struct encoding encoding_default;

bool encoding_same(const struct encoding *a, const struct encoding *b);

struct encoder;

/* One for all who get the same bytes. */
struct encoder *encoder_new(const struct encoding *encoding);
void encoder_free(struct encoder *encoder);

/* The next chunk that is written is one that a decoder can begin with. */
void encoder_restart(struct encoder *encoder);

/* Appends the message. Returns whether one can begin with it. */
bool encoder_chunk(struct encoder *encoder, const struct chunk *chunk, const struct fap_frame *frames,
                   struct buf *out);

/* The utterance has ended: appends a message with what the audio coder still holds, if that is anything. */
void encoder_end(struct encoder *encoder, struct buf *out);

#endif
