/* SPDX-License-Identifier: MIT */
#include "protocol/fba/fba_bits.h"
#include <stdlib.h>
#include <string.h>

unsigned fba_bit(struct fba_bits *bits) {
    size_t at = bits->at++;
    return at < bits->size ? bits->data[at / 8] >> (7 - at % 8) & 1u : 0;
}

uint32_t fba_bits_get(struct fba_bits *bits, int count) {
    uint32_t value = 0;
    while (count-- > 0)
        value = value << 1 | fba_bit(bits);
    return value;
}

static size_t code_place(const struct fba_bits *bits) {
    return (bits->at / 8 + 1) * 8;
}

/* A frame of 6 bits may end in the byte in which it begins, with a start code behind it. Its second and third
 * bit tell it from stuffing. */
static bool is_short_frame(const struct fba_bits *bits) {
    struct fba_bits ahead = *bits;
    return code_place(bits) - bits->at >= 6 && (fba_bits_get(&ahead, 3) & 3) == 1;
}

uint32_t fba_bits_next_code(const struct fba_bits *bits) {
    struct fba_bits ahead = *bits;
    if (is_short_frame(bits))
        return UINT32_MAX;
    ahead.at = code_place(bits);
    return ahead.at + 32 <= bits->size ? fba_bits_get(&ahead, 32) : UINT32_MAX;
}

void fba_bits_skip_code(struct fba_bits *bits) {
    bits->at = code_place(bits) + 32;
}

static bool grow(struct fba_sink *sink) {
    size_t cap = sink->cap ? sink->cap * 2 : 4096;
    uint8_t *data = cap > sink->cap ? realloc(sink->data, cap) : NULL;
    if (!data) {
        sink->failed = true;
        return false;
    }
    memset(data + sink->cap, 0, cap - sink->cap);
    sink->data = data;
    sink->cap = cap;
    return true;
}

void fba_put(struct fba_sink *sink, uint32_t value, int count) {
    for (int i = count - 1; i >= 0; i--) {
        size_t at = sink->size;
        if (sink->failed || (at / 8 == sink->cap && !grow(sink)))
            return;
        sink->data[at / 8] |= (uint8_t)((value >> i & 1u) << (7 - at % 8));
        sink->size++;
    }
}

void fba_put_code(struct fba_sink *sink, uint32_t code) {
    if (sink->size) {
        fba_put(sink, 0, 1);
        while (sink->size % 8 && !sink->failed)
            fba_put(sink, 1, 1);
    }
    fba_put(sink, code, 32);
}
