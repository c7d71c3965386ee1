/* SPDX-License-Identifier: MIT */
#include "protocol/chunk/chunk.h"
#include <string.h>

enum { MAGIC = 0x46 };

static void put16(uint8_t *at, uint32_t v) {
    at[0] = (uint8_t)v;
    at[1] = (uint8_t)(v >> 8);
}

static void put32(uint8_t *at, uint32_t v) {
    put16(at, v);
    put16(at + 2, v >> 16);
}

static uint32_t get16(const uint8_t *at) {
    return at[0] | (uint32_t)at[1] << 8;
}

static uint32_t get32(const uint8_t *at) {
    return get16(at) | get16(at + 2) << 16;
}

static uint8_t *put_varint(uint8_t *at, int32_t difference) {
    uint32_t v = (uint32_t)difference << 1 ^ (difference < 0 ? UINT32_MAX : 0);
    for (; v >= 0x80; v >>= 7)
        *at++ = (uint8_t)(v | 0x80);
    *at++ = (uint8_t)v;
    return at;
}

/* Differences wrap, so that any pair of 32 bit values has one. */
static int32_t minus(int32_t a, int32_t b) {
    return (int32_t)((uint32_t)a - (uint32_t)b);
}

static int32_t plus(int32_t a, int32_t b) {
    return (int32_t)((uint32_t)a + (uint32_t)b);
}

static int32_t value_of(const struct fap_frame *f, int n) {
    return fap_frame_has(f, n) ? f->value[n] : 0;
}

static struct fap_viseme viseme_of(const struct fap_frame *f) {
    return fap_frame_has(f, 1) ? f->viseme : (struct fap_viseme){0};
}

static struct fap_expression expression_of(const struct fap_frame *f) {
    return fap_frame_has(f, 2) ? f->expression : (struct fap_expression){0};
}

/* Appends the code of a frame and returns its end. Needs room for CHUNK_FRAME_BYTES_MAX bytes. */
static uint8_t *put_frame(uint8_t *at, const struct fap_frame *f, const struct fap_frame *before) {
    uint8_t *mask = at;
    struct fap_viseme viseme = viseme_of(f), viseme_before = viseme_of(before);
    struct fap_expression expression = expression_of(f), expression_before = expression_of(before);
    memset(mask, 0, FAP_MASK_BYTES);
    at += FAP_MASK_BYTES;
    if (memcmp(&viseme, &viseme_before, sizeof viseme)) {
        mask[0] |= 1;
        memcpy(at, &viseme, sizeof viseme);
        at += sizeof viseme;
    }
    if (memcmp(&expression, &expression_before, sizeof expression)) {
        mask[0] |= 2;
        memcpy(at, &expression, sizeof expression);
        at += sizeof expression;
    }
    for (int n = 3; n <= FAP_COUNT; n++) {
        int32_t difference = minus(value_of(f, n), value_of(before, n));
        if (!difference)
            continue;
        mask[(n - 1) / 8] |= (uint8_t)(1u << ((n - 1) % 8));
        at = put_varint(at, difference);
    }
    return at;
}

static bool can_encode(const struct chunk *c) {
    bool pcm = c->audio_codec == CHUNK_AUDIO_PCM_S16LE;
    if (!pcm && c->audio_codec != CHUNK_AUDIO_SILENCE)
        return false;
    if (c->audio_bytes != (pcm ? (uint64_t)c->samples * 2 : 0))
        return false;
    if (c->fap_codec > CHUNK_FAP_PLAIN || (c->fap_codec == CHUNK_FAP_NONE && c->frame_count))
        return false;
    return c->sample_rate && c->fps_hundreds;
}

static void put_header(uint8_t *out, const struct chunk *c) {
    out[0] = MAGIC;
    out[1] = CHUNK_VERSION;
    out[2] = c->audio_codec;
    out[3] = c->fap_codec;
    put32(out + 4, c->utterance);
    put32(out + 8, c->sample_rate);
    put16(out + 12, c->fps_hundreds);
    put16(out + 14, c->frame_count);
    put32(out + 16, c->start);
    put32(out + 20, c->samples);
    put32(out + 24, c->first_frame);
    put32(out + 28, c->audio_bytes);
}

size_t chunk_encode(const struct chunk *c, const struct fap_frame *frames, uint8_t *out, size_t cap) {
    static const struct fap_frame zero;
    if (!can_encode(c) || cap < CHUNK_HEADER_BYTES || cap - CHUNK_HEADER_BYTES < c->audio_bytes)
        return 0;
    put_header(out, c);
    size_t size = CHUNK_HEADER_BYTES;
    if (c->audio_bytes)
        memcpy(out + size, c->audio, c->audio_bytes);
    size += c->audio_bytes;
    for (size_t i = 0; i < c->frame_count; i++) {
        uint8_t code[CHUNK_FRAME_BYTES_MAX];
        size_t length = (size_t)(put_frame(code, &frames[i], i ? &frames[i - 1] : &zero) - code);
        if (cap - size < length)
            return 0;
        memcpy(out + size, code, length);
        size += length;
    }
    return size;
}

struct reader {
    const uint8_t *data;
    size_t size, at;
};

static const char *get_varint(struct reader *r, int32_t *difference) {
    uint32_t v = 0;
    for (int shift = 0; shift < 35; shift += 7) {
        if (r->at == r->size)
            return "a value is cut short";
        uint8_t byte = r->data[r->at++];
        if (shift == 28 && byte > 0x0F)
            break;
        v |= (uint32_t)(byte & 0x7F) << shift;
        if (byte < 0x80) {
            *difference = (int32_t)(v >> 1 ^ (v & 1 ? UINT32_MAX : 0));
            return NULL;
        }
    }
    r->at--;
    return "a value is longer than 32 bits";
}

static const char *get_bytes(struct reader *r, void *to, size_t count) {
    if (r->size - r->at < count)
        return "a value is cut short";
    memcpy(to, r->data + r->at, count);
    r->at += count;
    return NULL;
}

/* On entry *f holds the frame before. */
static const char *get_frame(struct reader *r, struct fap_frame *f) {
    uint8_t mask[FAP_MASK_BYTES];
    const char *wrong = get_bytes(r, mask, sizeof mask);
    if (wrong)
        return "a frame's mask is cut short";
    if (mask[8] & 0xF0) {
        r->at--;
        return "the mask names a FAP above 68";
    }
    if (mask[0] & 1)
        wrong = get_bytes(r, &f->viseme, 4);
    if (!wrong && mask[0] & 2)
        wrong = get_bytes(r, &f->expression, 6);
    for (int n = 3; n <= FAP_COUNT && !wrong; n++) {
        int32_t difference = 0;
        if (!(mask[(n - 1) / 8] >> ((n - 1) % 8) & 1))
            continue;
        wrong = get_varint(r, &difference);
        f->value[n] = plus(f->value[n], difference);
    }
    return wrong;
}

static const char *check_header(const uint8_t *data, size_t size, struct chunk *c, size_t *error_at) {
    static const struct {
        uint8_t at, low, high;
        const char *wrong;
    } limits[] = {{0, MAGIC, MAGIC, "not a media chunk"},
                  {1, CHUNK_VERSION, CHUNK_VERSION, "a version that is not known here"},
                  {2, 0, CHUNK_AUDIO_PCM_S16LE, "an audio codec that is not known here"},
                  {3, 0, CHUNK_FAP_PLAIN, "a FAP codec that is not known here"}};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        *error_at = limits[i].at;
        if (size <= limits[i].at || data[limits[i].at] < limits[i].low || data[limits[i].at] > limits[i].high)
            return size <= limits[i].at ? "the header is cut short" : limits[i].wrong;
    }
    *error_at = size;
    if (size < CHUNK_HEADER_BYTES)
        return "the header is cut short";
    *c = (struct chunk){
        .audio_codec = data[2],
        .fap_codec = data[3],
        .utterance = get32(data + 4),
        .sample_rate = get32(data + 8),
        .fps_hundreds = (uint16_t)get16(data + 12),
        .frame_count = (uint16_t)get16(data + 14),
        .start = get32(data + 16),
        .samples = get32(data + 20),
        .first_frame = get32(data + 24),
        .audio_bytes = get32(data + 28),
        .audio = data + CHUNK_HEADER_BYTES,
    };
    *error_at = 8;
    if (!c->sample_rate)
        return "a sample rate of 0";
    *error_at = 12;
    if (!c->fps_hundreds)
        return "a frame rate of 0";
    *error_at = 14;
    if (c->fap_codec == CHUNK_FAP_NONE && c->frame_count)
        return "frames without a codec";
    *error_at = 28;
    if (c->audio_bytes > size - CHUNK_HEADER_BYTES)
        return "the audio is cut short";
    if (c->audio_bytes != (c->audio_codec == CHUNK_AUDIO_SILENCE ? 0 : (uint64_t)c->samples * 2))
        return "the audio's length is not that of its samples";
    return NULL;
}

const char *chunk_decode(const uint8_t *data, size_t size, struct chunk *c, struct fap_frame *frames,
                         size_t frame_cap, size_t *error_at) {
    const char *wrong = check_header(data, size, c, error_at);
    if (wrong)
        return wrong;
    struct reader r = {data, size, CHUNK_HEADER_BYTES + (size_t)c->audio_bytes};
    struct fap_frame frame = {.mask = {255, 255, 255, 255, 255, 255, 255, 255, 15}};
    for (unsigned i = 0; i < c->frame_count && !wrong; i++) {
        wrong = get_frame(&r, &frame);
        if (!wrong && i < frame_cap)
            frames[i] = frame;
    }
    if (!wrong && r.at != size)
        wrong = "bytes after the last frame";
    *error_at = r.at;
    return wrong;
}
