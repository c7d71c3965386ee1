/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What waits to leave on one WebSocket connection. A message that goes to many is made once and shared. */
#ifndef FACCIA_HTTP_MESSAGE_QUEUE_H
#define FACCIA_HTTP_MESSAGE_QUEUE_H

#include "server/base/buf.h"
#include "server/http/websocket_reader.h"
#include <stdbool.h>

/* One message, as the frame that is sent: what a server sends is not masked, so it is the same for all. */
struct queued_message {
    unsigned refs;
    bool media;                  /* may be left out for a client that is too slow */
    const char *event;           /* of a text message: its type */
    struct queued_message *line; /* and the same for those who type, which it owns; or NULL */
    uint64_t born;               /* loop time when it was made, ms; of media */
    size_t size;                 /* of the message */
    uint8_t head;                /* bytes of the frame before it */
    uint8_t bytes[];
};

/* With one reference, which belongs to the caller. */
struct queued_message *queued_message_new(enum websocket_opcode opcode, const void *data, size_t size);

/* Bytes that are no frame. */
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

/* Takes a reference of its own. */
void message_queue_push(struct message_queue *box, struct queued_message *message);

/* The next to be sent, whose reference is the caller's; NULL when there is none. */
struct queued_message *message_queue_pop(struct message_queue *box);

/* For how long the oldest media have waited, ms. */
uint64_t message_queue_age(const struct message_queue *box, uint64_t now);

/* Leaves out the media that wait. */
void message_queue_drop_media(struct message_queue *box);

#endif
