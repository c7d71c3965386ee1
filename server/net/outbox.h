/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What waits to leave on one WebSocket connection. A message that goes to many is made once and shared. */
#ifndef FACCIA_NET_OUTBOX_H
#define FACCIA_NET_OUTBOX_H

#include "server/base/buf.h"
#include "server/net/websocket_reader.h"
#include <stdbool.h>

/* One message, as the frame that is sent: what a server sends is not masked, so it is the same for all. */
struct parcel {
    unsigned refs;
    bool media;        /* may be left out for a client that is too slow */
    const char *event; /* of a text message: its type */
    uint64_t born;     /* loop time when it was made, ms; of media */
    size_t size;       /* of the message */
    uint8_t head;      /* bytes of the frame before it */
    uint8_t bytes[];
};

/* With one reference, which belongs to the caller. */
struct parcel *parcel_new(enum websocket_opcode opcode, const void *data, size_t size);

/* Bytes that are no frame. */
struct parcel *parcel_plain(const void *data, size_t size);
const uint8_t *parcel_body(const struct parcel *parcel);
void parcel_release(struct parcel *parcel);

struct outbox {
    struct outbox_link *first, **last;
    size_t unsent; /* bytes */
};

void outbox_open(struct outbox *box);
void outbox_close(struct outbox *box);
bool outbox_empty(const struct outbox *box);

/* Takes a reference of its own. */
void outbox_push(struct outbox *box, struct parcel *parcel);

/* The next to be sent, whose reference is the caller's; NULL when there is none. */
struct parcel *outbox_pop(struct outbox *box);

/* For how long the oldest media have waited, ms. */
uint64_t outbox_age(const struct outbox *box, uint64_t now);

/* Leaves out the media that wait. */
void outbox_drop_media(struct outbox *box);

#endif
