/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void buf_free(struct buf *b) {
    free(b->data);
    *b = (struct buf){0};
}

void *buf_reserve(struct buf *b, size_t extra) {
    b->data = mem_grow(b->data, &b->cap, b->size + extra, 1);
    return b->data ? b->data + b->size : NULL; /* the buffer is empty and no room is requested */
}

void buf_add(struct buf *b, const void *data, size_t size) {
    if (!size)
        return;
    memcpy(buf_reserve(b, size), data, size);
    b->size += size;
}

void buf_printf(struct buf *b, const char *format, ...) {
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length > 0) {
        vsnprintf(buf_reserve(b, (size_t)length + 1), (size_t)length + 1, format, again);
        b->size += (size_t)length;
    }
    va_end(again);
}

int buf_add_stream(struct buf *b, FILE *file, size_t most) {
    struct stat about;
    const size_t before = b->size;
    bool regular = !fstat(fileno(file), &about) && S_ISREG(about.st_mode);
    /* Room for one byte more than there should be finds the end of the file without another growth. */
    size_t room = regular && (uint64_t)about.st_size < most ? (size_t)about.st_size + 1 : 65536;
    bool ended = false;
    errno = 0;
    while (!ended && b->size - before <= most) {
        size_t got = fread(buf_reserve(b, room), 1, room, file);
        b->size += got;
        ended = got < room;
        room = 65536;
    }
    int result = b->size - before > most ? EFBIG : ferror(file) ? (errno ? errno : EIO) : 0;
    if (result)
        b->size = before;
    return result;
}

int buf_add_file(struct buf *b, const char *path, size_t most) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return errno;
    int result = buf_add_stream(b, file, most);
    fclose(file);
    return result;
}

void buf_consume(struct buf *b, size_t size) {
    if (!size)
        return;
    b->size -= size;
    memmove(b->data, b->data + size, b->size);
}

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
