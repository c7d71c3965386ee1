/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/opus_audio.h"
#include "server/base/mem.h"
#include "server/codec/coder_pool.h"
#include <opus/opus.h>
#include <soxr.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1024 };

struct opus_audio {
    OpusEncoder *encoder;
    soxr_t resampler; /* NULL when the sound has the coder's rate */
    uint32_t rate;    /* of the coder */
    size_t packet;    /* samples per packet, at that rate */
    int skip;         /* also at that rate */
    unsigned level, bitrate;
    int16_t waiting[OPUS_PACKET_SAMPLES];
    size_t waiting_count;
    uint64_t in, coded; /* samples at the coder's rate: received, and in packets */
};

/* Returns the lowest rate of Opus that keeps everything the bit rate can code: higher frequencies cost
 * time and bits. */
static uint32_t coder_rate(uint32_t sample_rate, unsigned bitrate) {
    return sample_rate <= 8000                                     ? 8000
           : sample_rate <= 16000 || bitrate <= OPUS_BITRATE_VOICE ? 16000
           : sample_rate <= 24000                                  ? 24000
                                                                   : OPUS_RATE;
}

static int open_encoder(struct opus_audio *o, unsigned bitrate) {
    int error;
    o->encoder = opus_encoder_create((opus_int32)o->rate, 1, OPUS_APPLICATION_VOIP, &error);
    if (!o->encoder)
        return -1;
    opus_int32 skip = 0;
    opus_encoder_ctl(o->encoder, OPUS_SET_BITRATE((opus_int32)bitrate));
    opus_encoder_ctl(o->encoder, OPUS_SET_SIGNAL(OPUS_SIGNAL_VOICE));
    opus_encoder_ctl(o->encoder, OPUS_SET_INBAND_FEC(0));
    opus_encoder_ctl(o->encoder, OPUS_GET_LOOKAHEAD(&skip));
    o->skip = skip;
    return 0;
}

static int open_resampler(struct opus_audio *o, uint32_t rate) {
    soxr_error_t error = NULL;
    soxr_io_spec_t io = soxr_io_spec(SOXR_INT16_I, SOXR_INT16_I);
    io.flags = SOXR_NO_DITHER; /* the same speech gives the same packets */
    soxr_quality_spec_t quality = soxr_quality_spec(SOXR_MQ, 0);
    if (rate != o->rate)
        o->resampler = soxr_create(rate, o->rate, 1, &error, &io, &quality, NULL);
    return error ? -1 : 0;
}

struct opus_audio *opus_audio_new(uint32_t sample_rate, unsigned bitrate) {
    struct opus_audio *o = mem_alloc(sizeof *o);
    o->bitrate = bitrate ? bitrate : sample_rate <= OPUS_VOICE_RATE ? OPUS_BITRATE_VOICE : OPUS_BITRATE;
    o->rate = coder_rate(sample_rate, o->bitrate);
    o->packet = o->rate / (OPUS_RATE / OPUS_PACKET_SAMPLES);
    if (open_encoder(o, o->bitrate) || open_resampler(o, sample_rate)) {
        opus_audio_free(o);
        return NULL;
    }
    return o;
}

void opus_audio_free(struct opus_audio *o) {
    if (!o)
        return;
    if (o->encoder)
        opus_encoder_destroy(o->encoder);
    if (o->resampler)
        soxr_delete(o->resampler);
    free(o);
}

void opus_audio_set_level(struct opus_audio *o, unsigned level) {
    const struct codec_load_level *l = &codec_load_levels[level];
    if (level == o->level)
        return;
    o->level = level;
    /* never raise a low bit rate: CELT is poor at those */
    bool transform = l->transform && o->bitrate >= OPUS_BITRATE_VOICE;
    unsigned bitrate = transform && o->bitrate < OPUS_BITRATE_MOST ? OPUS_BITRATE_MOST : o->bitrate;
    opus_encoder_ctl(o->encoder, OPUS_SET_COMPLEXITY(l->transform && !transform ? 0 : l->complexity));
    opus_encoder_ctl(o->encoder, OPUS_SET_BITRATE((opus_int32)bitrate));
    /* at these bit rates libopus uses CELT for music */
    opus_encoder_ctl(o->encoder, OPUS_SET_SIGNAL(transform ? OPUS_SIGNAL_MUSIC : OPUS_SIGNAL_VOICE));
}

unsigned opus_audio_skip(const struct opus_audio *o) {
    return (unsigned)o->skip * (OPUS_RATE / o->rate);
}

static void put_packet(struct opus_audio *o, struct buf *out) {
    uint8_t *at = buf_reserve(out, 2 + OPUS_PACKET_BYTES), packet[OPUS_PACKET_BYTES];
    int size = opus_encode(o->encoder, o->waiting, (int)o->packet, packet, OPUS_PACKET_BYTES);
    if (size < 0)
        size = 0; /* empty: the decoder conceals it */
    int length = 1;
    at[0] = (uint8_t)size;
    if (size >= 252) {
        at[0] = (uint8_t)(252 + (size & 3));
        at[1] = (uint8_t)((size - at[0]) >> 2);
        length = 2;
    }
    memcpy(at + length, packet, (size_t)size);
    out->size += (size_t)(length + size);
    o->coded += o->packet;
    o->waiting_count = 0;
}

/* Takes samples at the coder's rate. */
static unsigned fill(struct opus_audio *o, const int16_t *pcm, size_t count, struct buf *out) {
    unsigned packets = 0;
    while (count) {
        size_t room = o->packet - o->waiting_count, take = count < room ? count : room;
        memcpy(o->waiting + o->waiting_count, pcm, take * sizeof *pcm);
        o->waiting_count += take;
        pcm += take;
        count -= take;
        if (o->waiting_count == o->packet) {
            put_packet(o, out);
            packets++;
        }
    }
    return packets;
}

/* pcm NULL = flush the filter. */
static unsigned resample(struct opus_audio *o, const int16_t *pcm, size_t count, struct buf *out) {
    int16_t block[BLOCK];
    unsigned packets = 0;
    for (;;) {
        size_t used = 0, made = 0;
        if (soxr_process(o->resampler, pcm, count, &used, block, BLOCK, &made))
            return packets;
        o->in += made;
        packets += fill(o, block, made, out);
        if (pcm) {
            pcm += used;
            count -= used;
        }
        if ((!pcm || !count) && made < BLOCK)
            return packets;
    }
}

unsigned opus_audio_add(struct opus_audio *o, const int16_t *pcm, size_t count, struct buf *out) {
    if (!count)
        return 0;
    if (o->resampler)
        return resample(o, pcm, count, out);
    o->in += count;
    return fill(o, pcm, count, out);
}

unsigned opus_audio_end(struct opus_audio *o, struct buf *out) {
    static const int16_t silence[OPUS_PACKET_SAMPLES];
    unsigned packets = o->resampler ? resample(o, NULL, 0, out) : 0;
    while (o->coded < o->in + (unsigned)o->skip)
        packets += fill(o, silence, o->packet - o->waiting_count, out);
    return packets;
}
