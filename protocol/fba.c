/* SPDX-License-Identifier: MIT */
#include "protocol/fba.h"
#include "protocol/rangecoder.h"
#include <string.h>

enum {
    HEADER_INTRA = 0x80,
    SEQUENCE_MASK = 0x7F,
    ZERO_FIRST = 3000, /* most FAPs stand still */
    WEIGHT_OWN = 90,   /* of 256: how much of its last step a FAP goes on with, to begin with */
    WEIGHT_LIKE = 256, /* how much of its model's step it takes over */
    WEIGHT_RATE = 6,
    STEP_CLAMP = 65535, /* steps larger than this are no matter of prediction */
    LONG_BITS = 30,
};

/* The FAP that a FAP moves like: the left one for the right, the inner lip for the outer one; 0 = none. Only
 * FAPs that have been coded before it. */
static const uint8_t like[FAP_COUNT + 1] = {
    [5] = 3,   [7] = 6,   [8] = 4,   [9] = 8,   [10] = 5,  [11] = 10, [13] = 12, [20] = 19, [21] = 19,
    [22] = 21, [24] = 23, [26] = 25, [28] = 27, [30] = 29, [32] = 31, [33] = 31, [34] = 33, [35] = 33,
    [36] = 35, [38] = 37, [40] = 39, [42] = 41, [51] = 4,  [52] = 5,  [53] = 6,  [54] = 7,  [55] = 8,
    [56] = 9,  [57] = 10, [58] = 11, [59] = 12, [60] = 13, [62] = 61, [66] = 65, [68] = 67,
};

/* Quarters of the MPEG-4 quantiser step: more where nobody sees it (tongue, lip protrusion, nose), less for
 * the head, whose slow motion would be seen to creep in steps. */
static int quarters(int n) {
    if (n >= 43 && n <= 46)
        return 16;
    if ((n >= 16 && n <= 18) || n == 37 || n == 38 || (n >= 61 && n <= 64))
        return 8;
    return n >= 48 && n <= 50 ? 2 : 4;
}

static int group_of(int n) {
    static const int firsts[FBA_GROUPS] = {61, 48, 43, 39, 31, 19, 3};
    if (n >= 51 && n <= 60)
        return FBA_GROUPS - 1; /* outer lips as inner */
    for (int g = 0; g < FBA_GROUPS; g++)
        if (n >= firsts[g])
            return g;
    return FBA_GROUPS - 1;
}

int32_t fba_step(int n, int quality) {
    int32_t step = (int32_t)fap_table[n].quant_step * quality * quarters(n) / 4;
    return quality && step > 0 ? step : 1;
}

static void reset(struct fba_state *s) {
    for (int i = 0; i < FBA_CTX_COUNT; i++)
        s->contexts[i] = (struct fba_context){i < FBA_CTX_SIGN ? ZERO_FIRST : 2048, 0};
    for (int n = 0; n <= FAP_COUNT; n++) {
        s->level[n] = s->slope[n] = 0;
        s->weight[n] = like[n] ? WEIGHT_LIKE : WEIGHT_OWN;
    }
    s->last = (struct fap_frame){0};
}

static int32_t clamp(int32_t x, int32_t limit) {
    return x < -limit ? -limit : x > limit ? limit : x;
}

static int sign(int32_t x) {
    return (x > 0) - (x < 0);
}

/* What is known before a FAP's step is coded. */
struct guess {
    int32_t source, step; /* the step that it is taken from, and the guess itself, in this FAP's steps */
    int zero, sign, size; /* contexts */
};

/* slope[m] of a model m that stands before n is the one of this frame already. */
static struct guess guess(const struct fba_state *s, int n) {
    struct guess g;
    int32_t own = clamp(s->slope[n], STEP_CLAMP), size = own < 0 ? -own : own;
    if (like[n]) {
        int m = like[n];
        g.source = clamp(clamp(s->slope[m], STEP_CLAMP) * fba_step(m, s->quality) / fba_step(n, s->quality),
                         STEP_CLAMP);
    } else {
        g.source = own;
    }
    /* rounded; the sum is made positive, since a shift of a negative number rounds as the machine likes */
    int32_t sum = s->weight[n] * g.source + 128;
    g.step = sum >= 0 ? sum >> 8 : -((-sum + 255) >> 8);
    g.zero = FBA_CTX_ZERO + n * 6 + (size < 2 ? (int)size : 2) + ((like[n] ? g.source : g.step) ? 3 : 0);
    g.sign = FBA_CTX_SIGN + n * 3 + 1 + sign(g.step ? g.step : own);
    g.size = FBA_CTX_SIZE + (group_of(n) * FBA_CLASSES + (size > 4   ? 3
                                                          : size > 1 ? 2
                                                                     : (int)size)) *
                                FBA_UNARY;
    return g;
}

/* After the step is known: the state goes on to it. */
static void follow(struct fba_state *s, int n, const struct guess *g, int32_t step) {
    int32_t weight = s->weight[n] + sign(step - g->step) * sign(g->source) * WEIGHT_RATE;
    int32_t low = like[n] ? -256 : -64, high = like[n] ? 400 : 300;
    s->weight[n] = weight < low ? low : weight > high ? high : weight;
    s->level[n] += step;
    s->slope[n] = step;
}

static int bits_of(uint32_t x) {
    int bits = 0;
    while (x >>= 1)
        bits++;
    return bits;
}

static void put_step(struct fba_state *s, struct range_encoder *e, int n, int32_t step) {
    struct guess g = guess(s, n);
    int32_t error = step - g.step;
    range_put(e, &s->contexts[g.zero], error != 0);
    if (error) {
        uint32_t rest = (uint32_t)(error < 0 ? -error : error) - 1, i = 0;
        range_put(e, &s->contexts[g.sign], error < 0);
        for (; i < FBA_UNARY && i < rest; i++)
            range_put(e, &s->contexts[g.size + (int)i], 1);
        if (i < FBA_UNARY) {
            range_put(e, &s->contexts[g.size + (int)i], 0);
        } else {
            uint32_t x = rest - FBA_UNARY + 1;
            int bits = bits_of(x), at = FBA_CTX_LONG + group_of(n) * FBA_PREFIX;
            for (int b = 0; b < bits; b++)
                range_put(e, &s->contexts[at + b], 1);
            range_put(e, &s->contexts[at + bits], 0);
            while (bits-- > 0)
                range_put_even(e, (int)(x >> bits & 1));
        }
    }
    follow(s, n, &g, step);
}

/* False when it cannot be: the bytes are damaged. */
static bool get_step(struct fba_state *s, struct range_decoder *d, int n) {
    struct guess g = guess(s, n);
    int32_t error = 0;
    if (range_get(d, &s->contexts[g.zero])) {
        int negative = range_get(d, &s->contexts[g.sign]);
        uint32_t rest = 0;
        while (rest < FBA_UNARY && range_get(d, &s->contexts[g.size + (int)rest]))
            rest++;
        if (rest == FBA_UNARY) {
            int bits = 0, at = FBA_CTX_LONG + group_of(n) * FBA_PREFIX;
            while (range_get(d, &s->contexts[at + bits]))
                if (++bits > LONG_BITS)
                    return false;
            uint32_t x = 1;
            for (int b = 0; b < bits; b++)
                x = x << 1 | (uint32_t)range_get_even(d);
            rest = x + FBA_UNARY - 1;
        }
        if (rest > 4u * FBA_VALUE_MAX)
            return false;
        error = (int32_t)rest + 1;
        error = negative ? -error : error;
    }
    int32_t step = g.step + error, level = s->level[n] + step;
    int32_t limit = FBA_VALUE_MAX / fba_step(n, s->quality) + 1;
    if (level < -limit || level > limit)
        return false;
    follow(s, n, &g, step);
    return true;
}

/* To the nearest step, halves away from 0. */
static int32_t quantise(int32_t value, int32_t step) {
    int32_t v = clamp(value, FBA_VALUE_MAX);
    return v < 0 ? -((-v + step / 2) / step) : (v + step / 2) / step;
}

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

static void put_frame(struct fba_state *s, struct range_encoder *e, const struct fap_frame *frame) {
    struct fap_frame now = *frame;
    int changed = memcmp(now.mask, s->last.mask, sizeof now.mask) != 0;
    range_put(e, &s->contexts[FBA_CTX_MASK], changed);
    for (int n = 1; changed && n <= FAP_COUNT; n++)
        range_put(e, &s->contexts[FBA_CTX_MASK + 1 + fap_frame_has(&s->last, n)], fap_frame_has(&now, n));
    for (int i = 0; i < 10; i++) {
        uint8_t *before = high_bytes(&s->last, i), value = *high_bytes(&now, i);
        if (!high_is_there(&now, i))
            continue;
        range_put(e, &s->contexts[FBA_CTX_HIGH + i], value != *before);
        for (int b = 7; value != *before && b >= 0; b--)
            range_put_even(e, value >> b & 1);
        *before = value;
    }
    memcpy(s->last.mask, now.mask, sizeof now.mask);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(&now, n))
            put_step(s, e, n, quantise(now.value[n], fba_step(n, s->quality)) - s->level[n]);
}

static bool get_frame(struct fba_state *s, struct range_decoder *d, struct fap_frame *frame) {
    uint8_t mask[FAP_MASK_BYTES] = {0};
    if (range_get(d, &s->contexts[FBA_CTX_MASK])) {
        for (int n = 1; n <= FAP_COUNT; n++) {
            int bit = range_get(d, &s->contexts[FBA_CTX_MASK + 1 + fap_frame_has(&s->last, n)]);
            mask[(n - 1) / 8] |= (uint8_t)(bit << ((n - 1) % 8));
        }
        memcpy(s->last.mask, mask, sizeof mask);
    }
    for (int i = 0; i < 10; i++) {
        if (!high_is_there(&s->last, i) || !range_get(d, &s->contexts[FBA_CTX_HIGH + i]))
            continue;
        int value = 0;
        for (int b = 0; b < 8; b++)
            value = value << 1 | range_get_even(d);
        *high_bytes(&s->last, i) = (uint8_t)value;
    }
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(&s->last, n) && !get_step(s, d, n))
            return false;
    *frame = s->last;
    for (int i = 0; i < 10; i++)
        if (!high_is_there(frame, i))
            *high_bytes(frame, i) = 0;
    for (int n = 3; n <= FAP_COUNT; n++)
        frame->value[n] = fap_frame_has(frame, n) ? s->level[n] * fba_step(n, s->quality) : 0;
    return true;
}

void fba_encoder_init(struct fba_encoder *encoder, int quality) {
    *encoder = (struct fba_encoder){0};
    encoder->state.quality = (uint8_t)(quality < 0                 ? 0
                                       : quality > FBA_QUALITY_MAX ? FBA_QUALITY_MAX
                                                                   : quality);
}

size_t fba_encode(struct fba_encoder *encoder, const struct fap_frame *frames, size_t count, bool intra,
                  uint8_t *out, size_t cap) {
    struct fba_state *s = &encoder->state;
    struct range_encoder e;
    size_t header = 0;
    if (count > FBA_FRAMES_MAX || cap < (count + 1) * FBA_FRAME_BYTES_MAX)
        return 0;
    intra |= !encoder->started;
    encoder->started = true;
    out[header++] = (uint8_t)(s->sequence | (intra ? HEADER_INTRA : 0));
    if (intra) {
        out[header++] = s->quality;
        reset(s);
    }
    s->sequence = (s->sequence + 1) & SEQUENCE_MASK;
    range_encoder_init(&e, out + header, cap - header);
    for (size_t i = 0; i < count; i++)
        put_frame(s, &e, &frames[i]);
    return header + range_finish(&e);
}

void fba_decoder_init(struct fba_decoder *decoder) {
    *decoder = (struct fba_decoder){0};
}

static const char *begin(struct fba_decoder *decoder, const uint8_t *data, size_t size, size_t *header) {
    struct fba_state *s = &decoder->state;
    if (!size)
        return "an empty packet";
    uint8_t sequence = data[0] & SEQUENCE_MASK;
    *header = 1;
    if (data[0] & HEADER_INTRA) {
        if (size < 2 || data[1] > FBA_QUALITY_MAX)
            return "a packet without its quality";
        s->quality = data[1];
        *header = 2;
        reset(s);
    } else if (!decoder->ready) {
        return "no packet to begin with has come yet";
    } else if (sequence != s->sequence) {
        return "a packet was lost";
    }
    s->sequence = (sequence + 1) & SEQUENCE_MASK;
    return NULL;
}

const char *fba_decode(struct fba_decoder *decoder, const uint8_t *data, size_t size,
                       struct fap_frame *frames, size_t count) {
    struct range_decoder d;
    size_t header = 0;
    const char *wrong =
        count > FBA_FRAMES_MAX ? "more frames than a packet can have" : begin(decoder, data, size, &header);
    decoder->ready = !wrong;
    if (wrong)
        return wrong;
    range_decoder_init(&d, data + header, size - header);
    for (size_t i = 0; i < count; i++)
        if (!get_frame(&decoder->state, &d, &frames[i])) {
            decoder->ready = false;
            return "a damaged packet";
        }
    return NULL;
}
