/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What turns chunks into bytes: the coders of one encoding, and where they have come. It belongs to one
 * thread at a time. */
#ifndef FACCIA_CODEC_MEDIA_CODER_H
#define FACCIA_CODEC_MEDIA_CODER_H

#include "protocol/chunk.h"
#include "server/base/buf.h"
#include "server/codec/encoding.h"

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

struct media_coder *media_coder_new(const struct encoding *encoding);
void media_coder_free(struct media_coder *coder);

/* Appends the message. */
struct media_bytes media_coder_chunk(struct media_coder *coder, const struct chunk *chunk,
                                     const struct fap_frame *frames, const struct media_terms *terms,
                                     struct buf *out);

/* The utterance has ended. heard: to its end; then a message with what the audio coder still holds is
 * appended, if that is anything. */
void media_coder_end(struct media_coder *coder, bool heard, const struct buf *events, struct buf *out);

#endif
