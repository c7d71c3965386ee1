/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growable byte buffer. Out of memory aborts the process (see mem.h). */
#ifndef FACCIA_BASE_BUF_H
#define FACCIA_BASE_BUF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct buf {
    uint8_t *data;
    size_t size, cap;
};

void buf_free(struct buf *b);
void *buf_reserve(struct buf *b, size_t extra); /* makes room for `extra` more bytes; returns where they go */
void buf_add(struct buf *b, const void *data, size_t size);
void buf_printf(struct buf *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Appends the rest of the stream, `most` bytes at most. Returns 0, or errno (EFBIG: it has more), and appends
 * nothing then. */
int buf_add_stream(struct buf *b, FILE *file, size_t most);
/* Likewise for the file at `path`. */
int buf_add_file(struct buf *b, const char *path, size_t most);
void buf_consume(struct buf *b, size_t size); /* drops the first `size` bytes */

/* Serialises numbers and strings for processes of the same machine and build: native byte order. */

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
