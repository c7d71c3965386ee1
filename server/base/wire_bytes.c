/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/wire_bytes.h"
#include <string.h>

/* Length that stands for NULL. */
#define NO_STRING UINT32_MAX

void wire_put_u32(struct buf *b, uint32_t v) {
    buf_add(b, &v, sizeof v);
}

void wire_put_u64(struct buf *b, uint64_t v) {
    buf_add(b, &v, sizeof v);
}

void wire_put_f64(struct buf *b, double v) {
    buf_add(b, &v, sizeof v);
}

void wire_put_string(struct buf *b, const char *s) {
    if (!s) {
        wire_put_u32(b, NO_STRING);
        return;
    }
    size_t length = strlen(s);
    wire_put_u32(b, (uint32_t)length);
    buf_add(b, s, length + 1);
}

static void get(struct wire_reader *r, void *out, size_t size) {
    if (r->bad || (size_t)(r->end - r->at) < size) {
        r->bad = true;
        memset(out, 0, size);
        return;
    }
    memcpy(out, r->at, size);
    r->at += size;
}

uint32_t wire_get_u32(struct wire_reader *r) {
    uint32_t v;
    get(r, &v, sizeof v);
    return v;
}

uint64_t wire_get_u64(struct wire_reader *r) {
    uint64_t v;
    get(r, &v, sizeof v);
    return v;
}

double wire_get_f64(struct wire_reader *r) {
    double v;
    get(r, &v, sizeof v);
    return v;
}

const char *wire_get_string(struct wire_reader *r) {
    uint32_t length = wire_get_u32(r);
    if (r->bad || length == NO_STRING)
        return NULL;
    if ((size_t)(r->end - r->at) <= length || memchr(r->at, '\0', (size_t)length + 1) != r->at + length) {
        r->bad = true;
        return NULL;
    }
    const char *s = (const char *)r->at;
    r->at += (size_t)length + 1;
    return s;
}
