/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one daemon sends to another: a line of JSON, and the bytes after it. */
#ifndef FACCIA_ROOMS_SHARED_PACKET_H
#define FACCIA_ROOMS_SHARED_PACKET_H

#include "server/base/buf.h"
#include <jansson.h>
#include <stdbool.h>

/* Another version's packets are passed over. */
enum { PACKET_VERSION = 4 };

struct packet {
    json_t *head;
    const char *kind, *room, *from; /* of the head; "" where it does not say */
    const uint8_t *body;            /* in what was read */
    size_t size;
};

/* The head of one about that room, to which members are added. */
json_t *packet_begin(const char *kind, const char *room);

/* Appends; drops the head. */
void packet_write(struct buf *out, json_t *head, const void *body, size_t size);

/* False when it is none, or of another version. The head has to be dropped. */
bool packet_read(const void *data, size_t size, struct packet *packet);

/* A whole number of the head, from 0; 0 where there is none. */
uint64_t packet_number(const struct packet *packet, const char *name);

#endif
