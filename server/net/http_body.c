/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies of known length, and chunked ones (RFC 9112, 6 and 7.1), to the letter. */
#include "server/net/http_reader.h"
#include <ctype.h>
#include <string.h>

enum {
    SIZE_DIGITS = 15,    /* of a chunk's size */
    LINE_BYTES = 1024,   /* a chunk's first line, with its extensions */
    TRAILER_BYTES = 8192 /* all fields after the last chunk */
};

static enum http_event bad_chunk(struct http_reader *r) {
    return http_reader_refuse(r, ERROR_BAD_CHUNK, "the body is not chunked as RFC 9112, 7.1 says");
}

static enum http_event give(struct http_reader *r, const uint8_t *bytes, size_t size, size_t *used) {
    size_t n = size < r->left ? size : (size_t)r->left;
    r->body = bytes;
    r->body_size = n;
    r->left -= n;
    *used += n;
    return HTTP_READ_BODY;
}

static void begin_line(struct http_reader *r) {
    r->line = r->digits = 0;
    r->extension = r->carriage = false;
}

/* One byte of a chunk's first line. False: it cannot be. */
static bool size_byte(struct http_reader *r, uint8_t c) {
    if (++r->line > LINE_BYTES)
        return false;
    if (r->carriage) {
        if (c != '\n' || !r->digits)
            return false;
        r->at = r->left ? HTTP_AT_CHUNK_DATA : HTTP_AT_TRAILER;
        begin_line(r);
        return true;
    }
    if (c == '\r')
        return r->carriage = true;
    if (r->extension)
        return c == '\t' || (c >= ' ' && c != 0x7F);
    if (isxdigit(c)) {
        r->left = r->left << 4 | (uint64_t)(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
        return ++r->digits <= SIZE_DIGITS;
    }
    r->extension = true;
    return r->digits && strchr("; \t", c);
}

/* The fields after the last chunk are of no use to anybody here. digits counts the bytes of the line. */
static bool trailer_byte(struct http_reader *r, uint8_t c) {
    if (++r->line > TRAILER_BYTES || (c < ' ' && !strchr("\t\r\n", c)) || !c)
        return false;
    if (r->carriage) {
        r->carriage = false;
        if (!r->digits)
            r->at = HTTP_AT_NEXT;
        r->digits = 0;
        return c == '\n';
    }
    r->carriage = c == '\r';
    r->digits += c != '\r';
    return c != '\n';
}

static bool between_byte(struct http_reader *r, uint8_t c) {
    if (!r->carriage)
        return r->carriage = c == '\r';
    r->at = HTTP_AT_CHUNK;
    begin_line(r);
    return c == '\n';
}

enum http_event http_body_feed(struct http_reader *r, const uint8_t *bytes, size_t size, size_t *used) {
    for (;;) {
        bool data = r->at == HTTP_AT_BODY || r->at == HTTP_AT_CHUNK_DATA;
        if (data && !r->left) {
            r->at = r->at == HTTP_AT_BODY ? HTTP_AT_NEXT : HTTP_AT_CHUNK_END;
            begin_line(r);
            continue;
        }
        if (r->at == HTTP_AT_NEXT)
            return HTTP_READ_END;
        if (*used == size)
            return HTTP_READ_MORE;
        if (data)
            return give(r, bytes + *used, size - *used, used);
        uint8_t c = bytes[(*used)++];
        bool good = r->at == HTTP_AT_CHUNK     ? size_byte(r, c)
                    : r->at == HTTP_AT_TRAILER ? trailer_byte(r, c)
                                               : between_byte(r, c);
        if (!good)
            return bad_chunk(r);
    }
}
