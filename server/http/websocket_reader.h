/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the frames of a WebSocket client (RFC 6455, 5), without any socket, and checks that a client may
 * send them. */
#ifndef FACCIA_HTTP_WEBSOCKET_READER_H
#define FACCIA_HTTP_WEBSOCKET_READER_H

#include "server/base/utf8.h"
#include <stdbool.h>

/* Status codes of the close frame (RFC 6455, 7.4.1). */
enum websocket_status {
    WEBSOCKET_NONE = 0, /* the close frame has no status */
    WEBSOCKET_NORMAL = 1000,
    WEBSOCKET_GOING_AWAY = 1001,
    WEBSOCKET_PROTOCOL = 1002,
    WEBSOCKET_BAD_TEXT = 1007,
    WEBSOCKET_POLICY = 1008,
    WEBSOCKET_TOO_LARGE = 1009,
};

enum websocket_opcode {
    WEBSOCKET_CONTINUATION = 0,
    WEBSOCKET_TEXT = 1,
    WEBSOCKET_BINARY = 2,
    WEBSOCKET_CLOSE = 8,
    WEBSOCKET_PING = 9,
    WEBSOCKET_PONG = 10,
};

enum { WEBSOCKET_CONTROL_BYTES = 125 /* most bytes of a control frame's payload */ };

/* Callbacks for what was parsed. */
struct websocket_ear {
    void (*piece)(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last);
    void (*ping)(void *ctx, const uint8_t *payload, size_t size);
    void (*pong)(void *ctx);
    void (*close)(void *ctx, enum websocket_status status);

    /* The client has violated the protocol; byte: the place of invalid UTF-8 in the message. Nothing more
     * is read. */
    void (*fault)(void *ctx, enum websocket_status status, const char *why, uint64_t byte);
};

struct websocket_reader {
    const struct websocket_ear *ear;
    void *ctx;
    uint64_t most;                 /* longest message that is still read, bytes */
    struct websocket_frame *frame; /* the incomplete frame; usually NULL */
    struct utf8_reader text;
    uint64_t message; /* bytes of the current message so far */
    bool begun;       /* a message has begun, and its last frame has not arrived */
    bool binary, ended;
    bool held; /* set by a callback, perhaps during the feed: nothing is taken until it is cleared */
};

/* Returns how many bytes were taken: all, unless it is held. */
size_t websocket_reader_feed(struct websocket_reader *reader, const uint8_t *bytes, size_t size);
void websocket_reader_free(struct websocket_reader *reader);

/* Writes the header of an unmasked server frame and returns its size. */
enum { WEBSOCKET_HEAD_BYTES = 10 };
size_t websocket_head(uint8_t head[WEBSOCKET_HEAD_BYTES], enum websocket_opcode opcode, size_t size);

#endif
