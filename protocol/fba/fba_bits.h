/* SPDX-License-Identifier: MIT */
/* Bits of an FBA stream, most significant first, and its start codes (ISO/IEC 14496-2, 5.2 and 6.2.1). */
#ifndef FACCIA_PROTOCOL_FBA_BITS_H
#define FACCIA_PROTOCOL_FBA_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    FBA_OBJECT_START = 0x1ba,
    FBA_PLANE_START = 0x1bb,
    FBA_SEQUENCE_END = 0x1b1,
    FBA_OBJECT_START_DRAFT = 0x101, /* of drafts before the codes above were given out */
    FBA_PLANE_START_DRAFT = 0x103,
};

struct fba_bits {
    const uint8_t *data;
    size_t size; /* bits */
    size_t at;   /* may go past size: bits there are 0 */
};

unsigned fba_bit(struct fba_bits *bits);
uint32_t fba_bits_get(struct fba_bits *bits, int count); /* 1..32 */

/* The 32 bits after the stuffing (a 0, then 1s up to the next byte; a whole byte where the position is at a
 * byte). UINT32_MAX past the end, and where a frame with FAPs fits before the byte. */
uint32_t fba_bits_next_code(const struct fba_bits *bits);
/* Advances over the stuffing and the start code. */
void fba_bits_skip_code(struct fba_bits *bits);

/* Writes into memory that grows. */
struct fba_sink {
    uint8_t *data; /* malloc'ed */
    size_t size;   /* bits */
    size_t cap;    /* bytes */
    bool failed;   /* memory is short; nothing more is written */
};

void fba_put(struct fba_sink *sink, uint32_t value, int count); /* the lowest `count` bits */
void fba_put_code(struct fba_sink *sink, uint32_t code); /* stuffing, unless at the beginning, and code */

#endif
