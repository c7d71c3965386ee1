/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speech as Opus packets (RFC 6716) of 20 ms, for media chunks: mono, 48 kHz clock, no in-band FEC, no
 * container. One encoder for one utterance. */
#ifndef FACCIA_CODEC_OPUS_AUDIO_H
#define FACCIA_CODEC_OPUS_AUDIO_H

#include "server/base/buf.h"
#include <stdint.h>

enum {
    OPUS_RATE = 48000,
    OPUS_PACKET_SAMPLES = 960,  /* 20 ms */
    OPUS_BITRATE = 20000,       /* bit/s, variable */
    OPUS_BITRATE_VOICE = 16000, /* of sound of at most OPUS_VOICE_RATE, as the voices make: up to 8 kHz it is
                                   as near to the original as 20000 for all of it, and above there is next
                                   to nothing (tests/bench/sound.mjs) */
    OPUS_VOICE_RATE = 24000,
    OPUS_BITRATE_MOST = 24000,
    OPUS_SKIP = 312,         /* what opus_audio_skip gives: 6.5 ms */
    OPUS_PACKET_BYTES = 400, /* most that a packet may have */
};

struct opus_audio;

/* For sound of that rate, 8000 to 192000 Hz. bitrate 0: what suits that. Of bit rates up to
 * OPUS_BITRATE_VOICE nothing is spent on what lies above 8 kHz. NULL when the libraries refuse. */
struct opus_audio *opus_audio_new(uint32_t sample_rate, unsigned bitrate);
void opus_audio_free(struct opus_audio *o);

/* How much work the packets from now on are given, one of codec_load.h's levels; CODEC_LOAD_BEST at first.
 * The bit rate becomes the level's, if that codes by transform and fewer were not asked for. */
void opus_audio_set_level(struct opus_audio *o, unsigned level);

/* Samples at 48 kHz that a decoder drops at the utterance's beginning, so that the packets' sound begins with
 * the first sample that was put in. */
unsigned opus_audio_skip(const struct opus_audio *o);

/* Takes samples and appends the packets that have become full, each after its length: one byte below 252, or
 * two (RFC 6716, 3.2.1). Returns how many packets. */
unsigned opus_audio_add(struct opus_audio *o, const int16_t *pcm, size_t count, struct buf *out);

/* The rest, filled up with silence: after this all that was put in can be heard. */
unsigned opus_audio_end(struct opus_audio *o, struct buf *out);

#endif
