/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serialises numbers and strings for processes of the same machine and build: native byte order. */
#ifndef FACCIA_BASE_WIRE_BYTES_H
#define FACCIA_BASE_WIRE_BYTES_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stdint.h>

/* A string is its length, its bytes and a NUL; NULL is a special length. */
void wire_put_u32(struct buf *b, uint32_t v);
void wire_put_u64(struct buf *b, uint64_t v);
void wire_put_string(struct buf *b, const char *s);
void wire_put_f64(struct buf *b, double v);

/* Reads a payload. After a truncated value, `bad` is set and all reads return 0 or NULL. Strings point
 * into the payload. */
struct wire_reader {
    const uint8_t *at, *end;
    bool bad;
};

uint32_t wire_get_u32(struct wire_reader *r);
uint64_t wire_get_u64(struct wire_reader *r);
double wire_get_f64(struct wire_reader *r);
const char *wire_get_string(struct wire_reader *r);

#endif
