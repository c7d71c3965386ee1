/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speech as Opus packets (RFC 6716) of 20 ms for media chunks: mono, 48 kHz clock, no in-band FEC, no
 * container. One encoder per utterance. */
#ifndef FACCIA_CODEC_OPUS_AUDIO_H
#define FACCIA_CODEC_OPUS_AUDIO_H

#include "server/base/buf.h"
#include <stdint.h>

enum {
    OPUS_RATE = 48000,
    OPUS_PACKET_SAMPLES = 960,  /* 20 ms */
    OPUS_BITRATE = 20000,       /* bit/s, variable */
    OPUS_BITRATE_VOICE = 16000, /* for sound of at most OPUS_VOICE_RATE, as voices have: up to 8 kHz as good
                                   as 20000, and there is little above (tests/bench/sound.mjs) */
    OPUS_VOICE_RATE = 24000,
    OPUS_BITRATE_MOST = 24000,
    OPUS_SKIP = 312,         /* value of opus_audio_skip: 6.5 ms */
    OPUS_PACKET_BYTES = 400, /* maximum of a packet */
};

struct opus_audio;

/* sample_rate: 8000 to 192000 Hz. bitrate 0: default for the rate. Up to OPUS_BITRATE_VOICE frequencies
 * above 8 kHz are not coded. Returns NULL when the libraries refuse. */
struct opus_audio *opus_audio_new(uint32_t sample_rate, unsigned bitrate);
void opus_audio_free(struct opus_audio *o);

/* Sets the effort for further packets to a level of coder_pool.h, initially CODEC_LOAD_BEST. Levels that
 * use transform coding raise the bit rate, unless a lower one was requested. */
void opus_audio_set_level(struct opus_audio *o, unsigned level);

/* Samples at 48 kHz that a decoder must drop at the beginning to align with the input. */
unsigned opus_audio_skip(const struct opus_audio *o);

/* Adds samples and appends complete packets, each after its length: one byte below 252, else two (RFC
 * 6716, 3.2.1). Returns the number of packets. */
unsigned opus_audio_add(struct opus_audio *o, const int16_t *pcm, size_t count, struct buf *out);

/* Pads the rest with silence, so that all input is coded. */
unsigned opus_audio_end(struct opus_audio *o, struct buf *out);

#endif
