/* SPDX-License-Identifier: MIT */
/* Numbers of 32 bits as LEB128: seven bits a byte, the lowest first, bit 7 set in all bytes but the last. */
#ifndef FACCIA_PROTOCOL_VARINT_H
#define FACCIA_PROTOCOL_VARINT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Writes up to 5 bytes. Returns how many. */
static inline size_t varint_put(uint8_t *out, uint32_t value) {
    size_t n = 0;
    for (; value >= 0x80; value >>= 7)
        out[n++] = (uint8_t)(value | 0x80);
    out[n++] = (uint8_t)value;
    return n;
}

/* Reads the number at *at, which is moved behind it. False when it is cut short or has more than 32 bits. */
static inline bool varint_get(const uint8_t **at, const uint8_t *end, uint32_t *value) {
    *value = 0;
    for (int shift = 0; shift < 35 && *at < end; shift += 7) {
        uint8_t byte = *(*at)++;
        if (shift == 28 && byte > 0x0F)
            return false;
        *value |= (uint32_t)(byte & 0x7F) << shift;
        if (byte < 0x80)
            return true;
    }
    return false;
}

#endif
