/* SPDX-License-Identifier: MIT */
#include "protocol/fapc/fapc.h"
#include "protocol/fapc/fapc_model.h"
#include <string.h>

enum { HEADER_INTRA = 0x80, SEQUENCE_MASK = 0x7F };

static uint8_t *high_bytes(struct fap_frame *f, int i) {
    uint8_t *const bytes[10] = {&f->viseme.select1,     &f->viseme.select2,        &f->viseme.blend,
                                &f->viseme.def,         &f->expression.select1,    &f->expression.intensity1,
                                &f->expression.select2, &f->expression.intensity2, &f->expression.init_face,
                                &f->expression.def};
    return bytes[i];
}

/* Does byte i of the high-level FAPs belong to this frame? The first four are FAP 1. */
static bool high_is_there(const struct fap_frame *f, int i) {
    return fap_frame_has(f, i < 4 ? 1 : 2);
}

static void put_frame(struct fapc_state *s, struct range_encoder *e, const struct fap_frame *frame) {
    struct fap_frame now = *frame;
    fapc_next_frame(s);
    int changed = memcmp(now.mask, s->last.mask, sizeof now.mask) != 0;
    range_put(e, &s->contexts[FAPC_CTX_MASK], changed);
    for (int n = 1; changed && n <= FAP_COUNT; n++)
        range_put(e, &s->contexts[FAPC_CTX_MASK + 1 + fap_frame_has(&s->last, n)], fap_frame_has(&now, n));
    for (int i = 0; i < 10; i++) {
        uint8_t *before = high_bytes(&s->last, i), value = *high_bytes(&now, i);
        if (!high_is_there(&now, i))
            continue;
        range_put(e, &s->contexts[FAPC_CTX_HIGH + i], value != *before);
        for (int b = 7; value != *before && b >= 0; b--)
            range_put_even(e, value >> b & 1);
        *before = value;
    }
    memcpy(s->last.mask, now.mask, sizeof now.mask);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(&now, n))
            fapc_put_value(s, e, n, now.value[n]);
}

static bool get_frame(struct fapc_state *s, struct range_decoder *d, struct fap_frame *frame) {
    uint8_t mask[FAP_MASK_BYTES] = {0};
    fapc_next_frame(s);
    if (range_get(d, &s->contexts[FAPC_CTX_MASK])) {
        for (int n = 1; n <= FAP_COUNT; n++) {
            int bit = range_get(d, &s->contexts[FAPC_CTX_MASK + 1 + fap_frame_has(&s->last, n)]);
            mask[(n - 1) / 8] |= (uint8_t)(bit << ((n - 1) % 8));
        }
        memcpy(s->last.mask, mask, sizeof mask);
    }
    for (int i = 0; i < 10; i++) {
        if (!high_is_there(&s->last, i) || !range_get(d, &s->contexts[FAPC_CTX_HIGH + i]))
            continue;
        int value = 0;
        for (int b = 0; b < 8; b++)
            value = value << 1 | range_get_even(d);
        *high_bytes(&s->last, i) = (uint8_t)value;
    }
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(&s->last, n) && !fapc_get_value(s, d, n))
            return false;
    *frame = s->last;
    for (int i = 0; i < 10; i++)
        if (!high_is_there(frame, i))
            *high_bytes(frame, i) = 0;
    for (int n = 3; n <= FAP_COUNT; n++)
        frame->value[n] = fap_frame_has(frame, n) ? s->value[0][n] : 0;
    return true;
}

void fapc_encoder_init(struct fapc_encoder *encoder, int quality) {
    *encoder = (struct fapc_encoder){0};
    encoder->state.quality = (uint8_t)(quality < 0                  ? 0
                                       : quality > FAPC_QUALITY_MAX ? FAPC_QUALITY_MAX
                                                                    : quality);
}

size_t fapc_encode(struct fapc_encoder *encoder, const struct fap_frame *frames, size_t count, bool intra,
                   uint8_t *out, size_t cap) {
    struct fapc_state *s = &encoder->state;
    struct range_encoder e;
    size_t header = 0;
    if (count > FAPC_FRAMES_MAX || cap < (count + 1) * FAPC_FRAME_BYTES_MAX)
        return 0;
    intra |= !encoder->started;
    encoder->started = true;
    out[header++] = (uint8_t)(s->sequence | (intra ? HEADER_INTRA : 0));
    if (intra) {
        out[header++] = s->quality;
        fapc_reset(s, s->quality);
    }
    s->sequence = (s->sequence + 1) & SEQUENCE_MASK;
    range_encoder_init(&e, out + header, cap - header);
    for (size_t i = 0; i < count; i++)
        put_frame(s, &e, &frames[i]);
    return header + range_finish(&e);
}

void fapc_decoder_init(struct fapc_decoder *decoder) {
    *decoder = (struct fapc_decoder){0};
}

static const char *begin(struct fapc_decoder *decoder, const uint8_t *data, size_t size, size_t *header) {
    struct fapc_state *s = &decoder->state;
    if (!size)
        return "an empty packet";
    uint8_t sequence = data[0] & SEQUENCE_MASK;
    *header = 1;
    if (data[0] & HEADER_INTRA) {
        if (size < 2 || data[1] > FAPC_QUALITY_MAX)
            return "a packet without its quality";
        *header = 2;
        fapc_reset(s, data[1]);
    } else if (!decoder->ready) {
        return "no packet to begin with has come yet";
    } else if (sequence != s->sequence) {
        return "a packet was lost";
    }
    s->sequence = (sequence + 1) & SEQUENCE_MASK;
    return NULL;
}

const char *fapc_decode(struct fapc_decoder *decoder, const uint8_t *data, size_t size,
                        struct fap_frame *frames, size_t count) {
    struct range_decoder d;
    size_t header = 0;
    const char *wrong =
        count > FAPC_FRAMES_MAX ? "more frames than a packet can have" : begin(decoder, data, size, &header);
    decoder->ready = !wrong;
    if (wrong)
        return wrong;
    range_decoder_init(&d, data + header, size - header);
    for (size_t i = 0; i < count && decoder->ready; i++)
        decoder->ready = get_frame(&decoder->state, &d, &frames[i]);
    decoder->ready &= !range_early(&d);
    return decoder->ready ? NULL : "a damaged packet";
}
