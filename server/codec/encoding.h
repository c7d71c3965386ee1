/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How somebody wants to have the media. */
#ifndef FACCIA_CODEC_ENCODING_H
#define FACCIA_CODEC_ENCODING_H

#include "server/base/error.h"
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

/* In compact chunks? */
bool encoding_is_compact(const struct encoding *encoding);

/* Do they go together? Plain FAPs are not coded beside Opus. */
bool encoding_possible(const struct encoding *encoding);

#endif
