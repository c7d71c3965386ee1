/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/heard_sound.h"
#include "server/base/mem.h"
#include "server/base/mixdown.h"
#include <math.h>
#include <opus/opus.h>
#include <stdlib.h>
#include <string.h>

/* A packet lasts 120 ms at most (RFC 6716, 2.1.4); one that is lost is taken for 20 ms. */
enum { PACKETS_A_SECOND = 50, LONGEST_PACKET = 6, OPUS_CHANNELS_MOST = 2, FRAME_BYTES_MOST = 16 };

const char *const heard_codecs[] = {[HEARD_PCM] = "pcm_s16le", [HEARD_OPUS] = "opus", NULL};

struct heard_sound {
    unsigned rate, channels;
    struct mixdown mixdown;
    OpusDecoder *opus; /* NULL: it is PCM */
    uint8_t part[FRAME_BYTES_MOST];
    size_t part_size; /* of a sample of all channels, of which the rest has not come */
    size_t bytes;     /* so far */
};

int heard_codec_find(const char *name, enum heard_codec *codec, struct error *e) {
    if (!strcmp(name, "pcm"))
        return *codec = HEARD_PCM, 0;
    for (int i = 0; heard_codecs[i]; i++)
        if (!strcmp(name, heard_codecs[i]))
            return *codec = (enum heard_codec)i, 0;
    return error_in_field(e, ERROR_UNKNOWN_CODEC, "codec", "no codec '%.32s'; there are pcm_s16le and opus",
                          name);
}

static bool opus_rate(unsigned rate) {
    return rate == 8000 || rate == 12000 || rate == 16000 || rate == 24000 || rate == 48000;
}

int heard_request_check(const struct heard_request *r, struct error *e) {
    if (r->rate < HEARD_RATE_LEAST || r->rate > HEARD_RATE_MOST)
        return error_in_field(e, ERROR_BAD_FIELD, "rate", "must be a number of samples a second, %d to %d",
                              HEARD_RATE_LEAST, HEARD_RATE_MOST);
    if (r->channels < 1 || r->channels > HEARD_CHANNELS_MOST)
        return error_in_field(e, ERROR_BAD_FIELD, "channels", "must be 1 to %d", HEARD_CHANNELS_MOST);
    if (r->codec == HEARD_OPUS && !opus_rate(r->rate))
        return error_in_field(e, ERROR_BAD_FIELD, "rate",
                              "of Opus must be 8000, 12000, 16000, 24000 or 48000");
    if (r->codec == HEARD_OPUS && r->channels > OPUS_CHANNELS_MOST)
        return error_in_field(e, ERROR_BAD_FIELD, "channels", "of Opus must be 1 or 2");
    return 0;
}

struct heard_sound *heard_sound_new(const struct heard_request *r, struct error *e) {
    if (heard_request_check(r, e))
        return NULL;
    struct heard_sound *s = mem_alloc(sizeof *s);
    *s = (struct heard_sound){.rate = r->rate, .channels = r->channels};
    int status = OPUS_OK;
    if (r->codec == HEARD_OPUS)
        s->opus = opus_decoder_create((opus_int32)r->rate, (int)r->channels, &status);
    if (status == OPUS_OK)
        return s;
    error_set(e, ERROR_BAD_SOUND, "Opus: %s", opus_strerror(status));
    free(s);
    return NULL;
}

void heard_sound_free(struct heard_sound *s) {
    if (s && s->opus)
        opus_decoder_destroy(s->opus);
    free(s);
}

struct taker {
    void (*give)(void *ctx, const int16_t *samples, size_t count);
    void *ctx;
};

static void mix(struct heard_sound *s, const int16_t *samples, size_t frames, const struct taker *to) {
    int16_t mono[HEARD_BLOCK];
    float frame[HEARD_CHANNELS_MOST];
    while (frames) {
        size_t count = frames < HEARD_BLOCK ? frames : HEARD_BLOCK;
        for (size_t i = 0; i < count; i++, samples += s->channels) {
            for (unsigned c = 0; c < s->channels; c++)
                frame[c] = (float)samples[c] / 32768;
            mono[i] = (int16_t)fmin(32767, lrint(32768 * mixdown_frame(&s->mixdown, frame, s->channels)));
        }
        to->give(to->ctx, mono, count);
        frames -= count;
    }
}

/* Whatever was sent in pieces is put together sample by sample. */
static void read_pcm(struct heard_sound *s, const uint8_t *bytes, size_t size, const struct taker *to) {
    int16_t block[1024];
    const size_t frame = s->channels * sizeof *block;
    const size_t most = sizeof block / frame;
    size_t frames = 0;
    for (size_t i = 0; i < size; i++) {
        s->part[s->part_size++] = bytes[i];
        if (s->part_size < frame)
            continue;
        for (size_t c = 0; c < s->channels; c++)
            block[frames * s->channels + c] =
                (int16_t)(uint16_t)(s->part[2 * c] | (unsigned)s->part[2 * c + 1] << 8);
        s->part_size = 0;
        if (++frames == most) {
            mix(s, block, frames, to);
            frames = 0;
        }
    }
    mix(s, block, frames, to);
}

static int read_opus(struct heard_sound *s, const uint8_t *bytes, size_t size, const struct taker *to,
                     struct error *e) {
    const int lost = (int)s->rate / PACKETS_A_SECOND, most = lost * LONGEST_PACKET;
    opus_int16 *samples = mem_alloc((size_t)most * s->channels * sizeof *samples);
    int failed = 0;
    int frames = size && size <= INT32_MAX ? opus_decode(s->opus, bytes, (opus_int32)size, samples, most, 0)
                                           : OPUS_INVALID_PACKET;
    if (frames < 0) {
        failed =
            error_at_byte(e, ERROR_BAD_SOUND, s->bytes, "this is no Opus packet: %s", opus_strerror(frames));
        frames = opus_decode(s->opus, NULL, 0, samples, lost, 0);
    }
    if (frames > 0)
        mix(s, samples, (size_t)frames, to);
    free(samples);
    return failed;
}

int heard_sound_read(struct heard_sound *s, const uint8_t *bytes, size_t size,
                     void (*give)(void *ctx, const int16_t *samples, size_t count), void *ctx,
                     struct error *e) {
    const struct taker to = {give, ctx};
    int failed = 0;
    if (s->opus)
        failed = read_opus(s, bytes, size, &to, e);
    else
        read_pcm(s, bytes, size, &to);
    s->bytes += size;
    return failed;
}

int heard_sound_end(const struct heard_sound *s, struct error *e) {
    return s->part_size ? error_at_byte(e, ERROR_BAD_SOUND, s->bytes, "the last sample is not whole") : 0;
}
