/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is stored in Redis: packed sound, and sentences and answers of the work queue. */
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
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

void work_form(char form[WORK_FORM_BYTES + 1]) {
    const uint16_t one = 1;
    memcpy(form, "fw1b", WORK_FORM_BYTES + 1);
    if (*(const uint8_t *)&one)
        form[WORK_FORM_BYTES - 1] = 'l';
}

static void put_form(struct buf *out) {
    char form[WORK_FORM_BYTES + 1];
    work_form(form);
    buf_add(out, form, WORK_FORM_BYTES);
}

static bool has_form(const void *data, size_t size) {
    char form[WORK_FORM_BYTES + 1];
    work_form(form);
    return size >= WORK_FORM_BYTES && !memcmp(data, form, WORK_FORM_BYTES);
}

void work_pack_sentence(const struct buf *sentence, struct buf *out) {
    put_form(out);
    buf_add(out, sentence->data, sentence->size);
}

bool work_unpack_sentence(const void *data, size_t size, struct buf *out) {
    if (!has_form(data, size))
        return false;
    buf_add(out, (const uint8_t *)data + WORK_FORM_BYTES, size - WORK_FORM_BYTES);
    return true;
}

/* Writes the length in one byte, which is enough for both texts. */
static void put_text(struct buf *out, const char *text) {
    uint8_t length = (uint8_t)strlen(text);
    buf_add(out, &length, 1);
    buf_add(out, text, length);
}

static bool get_text(const uint8_t **at, const uint8_t *end, char *text, size_t cap) {
    size_t length = *at < end ? *(*at)++ : cap;
    if (length >= cap || (size_t)(end - *at) < length || memchr(*at, '\0', length))
        return false;
    memcpy(text, *at, length);
    text[length] = '\0';
    *at += length;
    return true;
}

/* Layout after the tag: end, last, index (little-endian), the two texts, the body. */
enum { FIXED_BYTES = WORK_FORM_BYTES + 2 + 4 };

void work_pack_piece(const struct work_piece *piece, struct buf *out) {
    put_form(out);
    uint8_t fixed[FIXED_BYTES - WORK_FORM_BYTES] = {(uint8_t)piece->end, piece->last};
    for (int i = 0; i < 4; i++)
        fixed[2 + i] = (uint8_t)(piece->index >> 8 * i);
    buf_add(out, fixed, sizeof fixed);
    put_text(out, piece->task);
    put_text(out, piece->attempt);
    if (piece->size)
        buf_add(out, piece->body, piece->size);
}

bool work_unpack_piece(const void *data, size_t size, struct work_piece *piece) {
    const uint8_t *at = data, *end = at + size;
    if (!has_form(data, size) || size < FIXED_BYTES)
        return false;
    *piece = (struct work_piece){.end = at[WORK_FORM_BYTES], .last = at[WORK_FORM_BYTES + 1] == 1};
    if (at[WORK_FORM_BYTES] >= WORK_ENDS || at[WORK_FORM_BYTES + 1] > 1)
        return false;
    for (int i = 0; i < 4; i++)
        piece->index |= (unsigned)at[WORK_FORM_BYTES + 2 + i] << 8 * i;
    at += FIXED_BYTES;
    if (!get_text(&at, end, piece->task, sizeof piece->task) ||
        !get_text(&at, end, piece->attempt, sizeof piece->attempt))
        return false;
    piece->body = at;
    piece->size = (size_t)(end - at);
    return true;
}
