/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads HTTP/1 requests (RFC 9112) out of the bytes of a connection, without any socket. What could be read
 * in two ways is refused. */
#ifndef FACCIA_HTTP_HTTP_READER_H
#define FACCIA_HTTP_HTTP_READER_H

#include "server/http/http_request.h"

enum {
    HTTP_TARGET_BYTES = 8192, /* longest target of a request: 414 */
    HTTP_HEAD_BYTES = 16384,  /* longest head: 431 */
    HTTP_FIELDS = 100,        /* most header fields: 431 */
};

enum http_event {
    HTTP_READ_MORE,  /* all bytes were taken, and more are needed */
    HTTP_READ_HEAD,  /* the request's head is there */
    HTTP_READ_BODY,  /* a piece of its body */
    HTTP_READ_END,   /* the request is complete; the next one may follow */
    HTTP_READ_WRONG, /* with the error; nothing further can be read */
};

struct http_reader {
    struct http_request
        request;         /* from HTTP_READ_HEAD on, until the head after the next HTTP_READ_END begins */
    const uint8_t *body; /* HTTP_READ_BODY: the piece, among the bytes that were given */
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
    uint64_t left;   /* of the body, or of the chunk */
    size_t line;     /* bytes of the line that is read: of a chunk, or of all trailers */
    unsigned digits; /* of the chunk's size */
    bool extension, carriage;
    unsigned blank, lines; /* of the head: bytes of empty lines before it; its lines so far */
};

/* Takes bytes up to the next event; *used of them. */
enum http_event http_reader_feed(struct http_reader *reader, const void *bytes, size_t size, size_t *used);
void http_reader_free(struct http_reader *reader);

/* Has any byte of a further request come? */
bool http_reader_begun(const struct http_reader *reader);

#endif
