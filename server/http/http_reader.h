/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses HTTP/1 requests (RFC 9112) from the bytes of a connection, without any socket. Ambiguous input is
 * rejected. */
#ifndef FACCIA_HTTP_HTTP_READER_H
#define FACCIA_HTTP_HTTP_READER_H

#include "server/http/http_request.h"

enum {
    HTTP_TARGET_BYTES = 8192, /* longest request target: 414 */
    HTTP_HEAD_BYTES = 16384,  /* longest head: 431 */
    HTTP_FIELDS = 100,        /* most header fields: 431 */
};

enum http_event {
    HTTP_READ_MORE,  /* all bytes were taken, more are needed */
    HTTP_READ_HEAD,  /* the request's head is complete */
    HTTP_READ_BODY,  /* a piece of its body */
    HTTP_READ_END,   /* the request is complete; another may follow */
    HTTP_READ_WRONG, /* invalid, see `error`; nothing more can be read */
};

struct http_reader {
    struct http_request
        request;         /* valid from HTTP_READ_HEAD until the head after the next HTTP_READ_END begins */
    const uint8_t *body; /* HTTP_READ_BODY: the piece, within the caller's bytes */
    size_t body_size;
    struct error error;
    enum {
        HTTP_AT_HEAD,
        HTTP_AT_BODY,
        HTTP_AT_CHUNK, /* its first line */
        HTTP_AT_CHUNK_DATA,
        HTTP_AT_CHUNK_END,
        HTTP_AT_TRAILER,
        HTTP_AT_NEXT, /* the request is complete */
        HTTP_AT_WRONG
    } at;
    uint64_t left;   /* bytes left of the body or the chunk */
    size_t line;     /* bytes of the current line of a chunk, or of all trailers */
    unsigned digits; /* of the chunk's size */
    bool extension, carriage;
    unsigned blank, lines; /* bytes of empty lines before the head; lines of the head so far */
};

/* Consumes bytes up to the next event; *used is their count. */
enum http_event http_reader_feed(struct http_reader *reader, const void *bytes, size_t size, size_t *used);
void http_reader_free(struct http_reader *reader);

/* Returns whether part of another request has arrived. */
bool http_reader_begun(const struct http_reader *reader);

#endif
