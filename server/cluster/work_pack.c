/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/work_pack.h"
#include <string.h>

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
