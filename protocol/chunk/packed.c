/* SPDX-License-Identifier: MIT */
#include "protocol/chunk/packed.h"
#include "protocol/chunk/varint.h"
#include <string.h>

static int has_place(enum packed_kind kind) {
    return kind == PACKED_SENTENCE || kind == PACKED_WORD;
}

size_t packed_write(const struct packed_event *e, uint8_t *out) {
    size_t n = 0;
    out[n++] = (uint8_t)e->kind;
    n += varint_put(out + n, e->sample);
    if (e->kind != PACKED_MARK)
        n += varint_put(out + n, e->duration);
    if (has_place(e->kind)) {
        n += varint_put(out + n, e->start);
        n += varint_put(out + n, e->start - e->utf16_start); /* text before it that is not ASCII */
    }
    n += varint_put(out + n, e->size);
    memcpy(out + n, e->text, e->size);
    return n + e->size;
}

const char *packed_read(const uint8_t **at, const uint8_t *end, struct packed_event *event) {
    struct packed_event e = {0};
    uint32_t shift = 0;
    if (*at == end)
        return "no event";
    if (**at > PACKED_PHONE)
        return "an event of a kind that is not known here";
    e.kind = *(*at)++;
    if (!varint_get(at, end, &e.sample) || (e.kind != PACKED_MARK && !varint_get(at, end, &e.duration)) ||
        (has_place(e.kind) && (!varint_get(at, end, &e.start) || !varint_get(at, end, &shift))) ||
        !varint_get(at, end, &e.size) || e.size > (size_t)(end - *at))
        return "an event is cut short";
    if (shift > e.start)
        return "a place that cannot be";
    e.utf16_start = e.start - shift;
    e.text = (const char *)*at;
    *at += e.size;
    *event = e;
    return NULL;
}
