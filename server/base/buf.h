/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growable byte buffer. Out of memory aborts the process (see mem.h). */
#ifndef FACCIA_BASE_BUF_H
#define FACCIA_BASE_BUF_H

#include <stddef.h>
#include <stdint.h>

struct buf {
    uint8_t *data;
    size_t size, cap;
};

void buf_free(struct buf *b);
void *buf_reserve(struct buf *b, size_t extra); /* makes room for `extra` more bytes; returns where they go */
void buf_add(struct buf *b, const void *data, size_t size);
void buf_printf(struct buf *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Appends the file's bytes, `most` at most. Returns 0, or errno (EFBIG: it has more), and appends nothing then. */
int buf_add_file(struct buf *b, const char *path, size_t most);
void buf_consume(struct buf *b, size_t size); /* drops the first `size` bytes */

#endif
