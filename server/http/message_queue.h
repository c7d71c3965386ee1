/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Send queue of one WebSocket. A message for many clients is built once and shared. */
#ifndef FACCIA_HTTP_MESSAGE_QUEUE_H
#define FACCIA_HTTP_MESSAGE_QUEUE_H

#include "server/base/buf.h"
#include "server/http/websocket_reader.h"
#include <stdbool.h>

/* One message as a complete frame. Server frames are not masked (RFC 6455, 5.1), so all clients get the
 * same bytes. */
struct queued_message {
    unsigned refs;
    bool media;        /* may be dropped for a client that is too slow */
    const char *event; /* type of a text message */
    struct queued_message
        *line;     /* the same message for clients of the text protocol, owned by this one; or NULL */
    uint64_t born; /* loop time of its creation, ms; for media */
    size_t size;   /* of the message, bytes */
    uint8_t head;  /* size of the frame header, bytes */
    uint8_t bytes[];
};

/* Returns a message with one reference, owned by the caller. */
struct queued_message *queued_message_new(enum websocket_opcode opcode, const void *data, size_t size);

/* The same for raw bytes without a frame. */
struct queued_message *queued_message_plain(const void *data, size_t size);
const uint8_t *queued_message_body(const struct queued_message *message);
void queued_message_release(struct queued_message *message);

struct message_queue {
    struct message_queue_link *first, **last;
    size_t unsent; /* bytes */
};

void message_queue_open(struct message_queue *box);
void message_queue_close(struct message_queue *box);
bool message_queue_empty(const struct message_queue *box);

/* Appends the message, adding a reference. */
void message_queue_push(struct message_queue *box, struct queued_message *message);

/* Returns the next message, whose reference passes to the caller; NULL if empty. */
struct queued_message *message_queue_pop(struct message_queue *box);

/* Returns how long the oldest media have waited, ms. */
uint64_t message_queue_age(const struct message_queue *box, uint64_t now);

/* Drops the media in the queue. */
void message_queue_drop_media(struct message_queue *box);

#endif
