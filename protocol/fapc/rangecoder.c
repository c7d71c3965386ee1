/* SPDX-License-Identifier: MIT */
#include "protocol/fapc/rangecoder.h"

enum { ONE = 65536, LEAST = 64, SEEN_MAX = 60 };
#define TOP 0x1000000u

/* Adaptation step by number of uses: the more often a context was used, the smaller its step. */
static void learn(struct range_context *c, int bit) {
    uint32_t rate = 10 * ONE / (10 * (uint32_t)c->seen + 16), p = c->zero;
    if (c->seen < SEEN_MAX)
        c->seen++;
    p = bit ? p - (uint32_t)((uint64_t)p * rate / ONE) : p + (uint32_t)((uint64_t)(ONE - p) * rate / ONE);
    c->zero = (uint16_t)(p < LEAST ? LEAST : p > ONE - LEAST ? ONE - LEAST : p);
}

void range_encoder_init(struct range_encoder *e, uint8_t *out, size_t cap) {
    *e = (struct range_encoder){.range = UINT32_MAX, .out = out, .cap = cap};
}

static void put_byte(struct range_encoder *e, uint8_t byte) {
    if (e->size < e->cap)
        e->out[e->size] = byte;
    e->size++;
}

/* The top byte of low leaves; what it carries over goes into the bytes before it. */
static void shift(struct range_encoder *e) {
    if (e->low >> 32) {
        for (size_t i = e->size < e->cap ? e->size : e->cap; i-- > 0 && ++e->out[i] == 0;)
            ;
        e->low &= UINT32_MAX;
    }
    put_byte(e, (uint8_t)(e->low >> 24));
    e->low = (e->low << 8) & UINT32_MAX;
}

static void put(struct range_encoder *e, uint32_t bound, int bit) {
    if (bit) {
        e->low += bound;
        e->range -= bound;
    } else {
        e->range = bound;
    }
    while (e->range < TOP) {
        shift(e);
        e->range <<= 8;
    }
}

void range_put(struct range_encoder *e, struct range_context *context, int bit) {
    put(e, (e->range >> 16) * context->zero, bit);
    learn(context, bit);
}

void range_put_even(struct range_encoder *e, int bit) {
    put(e, e->range >> 1, bit);
}

size_t range_finish(struct range_encoder *e) {
    /* the range is at least TOP wide, so a multiple of TOP lies in it */
    e->low = (e->low + TOP - 1) & ~(uint64_t)(TOP - 1);
    shift(e);
    if (e->size <= e->cap)
        while (e->size && e->out[e->size - 1] == 0)
            e->size--;
    return e->size;
}

static uint8_t next_byte(struct range_decoder *d) {
    if (d->at < d->end)
        return *d->at++;
    d->beyond++;
    return 0;
}

void range_decoder_init(struct range_decoder *d, const uint8_t *data, size_t size) {
    *d = (struct range_decoder){.range = UINT32_MAX, .at = data, .end = data + size};
    for (int i = 0; i < 4; i++)
        d->code = d->code << 8 | next_byte(d);
}

static int get(struct range_decoder *d, uint32_t bound) {
    int bit = d->code >= bound;
    if (bit) {
        d->code -= bound;
        d->range -= bound;
    } else {
        d->range = bound;
    }
    while (d->range < TOP) {
        d->code = d->code << 8 | next_byte(d);
        d->range <<= 8;
    }
    return bit;
}

int range_get(struct range_decoder *d, struct range_context *context) {
    int bit = get(d, (d->range >> 16) * context->zero);
    learn(context, bit);
    return bit;
}

int range_get_even(struct range_decoder *d) {
    return get(d, d->range >> 1);
}

bool range_early(const struct range_decoder *d) {
    /* three bytes are read ahead */
    return (size_t)(d->end - d->at) + 3 > d->beyond;
}
