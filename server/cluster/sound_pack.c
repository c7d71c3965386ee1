/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/sound_pack.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Header of packed data: a byte for the format, and the size, little-endian. */
enum { FORM = 1, SIZE_BYTES = 4, HEADER_BYTES = 1 + SIZE_BYTES, LEVEL = 1 };

void sound_pack(const struct buf *value, struct buf *out) {
    size_t half = value->size / 2, most = compressBound(value->size);
    uint8_t *planes = mem_alloc(value->size + 1);
    uint16_t before = 0;
    for (size_t i = 0; i < half; i++) {
        uint16_t word = (uint16_t)(value->data[2 * i] | value->data[2 * i + 1] << 8),
                 step = (uint16_t)(word - before);
        planes[i] = (uint8_t)(step >> 8);
        planes[half + i] = (uint8_t)step;
        before = word;
    }
    if (value->size % 2)
        planes[value->size - 1] = value->data[value->size - 1];
    uint8_t *to = buf_reserve(out, HEADER_BYTES + most);
    *to++ = FORM;
    for (int i = 0; i < SIZE_BYTES; i++)
        *to++ = (uint8_t)(value->size >> 8 * i);
    uLongf packed = most;
    compress2(to, &packed, planes, value->size, LEVEL);
    out->size += HEADER_BYTES + packed;
    free(planes);
}

bool sound_unpack(const void *data, size_t size, size_t most, struct buf *out) {
    const uint8_t *from = data;
    size_t wanted = 0;
    if (size < HEADER_BYTES || *from++ != FORM)
        return false;
    for (int i = 0; i < SIZE_BYTES; i++)
        wanted |= (size_t)*from++ << 8 * i;
    if (wanted > most)
        return false;
    uint8_t *planes = mem_alloc(wanted + 1), *to = buf_reserve(out, wanted);
    uLongf got = wanted;
    bool well = uncompress(planes, &got, from, size - HEADER_BYTES) == Z_OK && got == wanted;
    uint16_t word = 0;
    for (size_t i = 0, half = wanted / 2; well && i < half; i++) {
        word = (uint16_t)(word + (planes[i] << 8 | planes[half + i]));
        to[2 * i] = (uint8_t)word;
        to[2 * i + 1] = (uint8_t)(word >> 8);
    }
    if (well && wanted % 2)
        to[wanted - 1] = planes[wanted - 1];
    out->size += well ? wanted : 0;
    free(planes);
    return well;
}
