/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packets between daemons: a line of JSON (the head), then bytes (the body). */
#ifndef FACCIA_ROOMS_SHARED_PACKET_H
#define FACCIA_ROOMS_SHARED_PACKET_H

#include "server/base/buf.h"
#include <jansson.h>
#include <stdbool.h>

/* Packets of another version are ignored. */
enum { PACKET_VERSION = 5 };

struct packet {
    json_t *head;
    const char *kind, *room, *from; /* borrowed from the head; "" if missing */
    const uint8_t *body;            /* points into the data that was read */
    size_t size;
};

/* Creates the head of a packet about the room; the caller adds members. */
json_t *packet_begin(const char *kind, const char *room);

/* Appends the packet to out; releases the head. */
void packet_write(struct buf *out, json_t *head, const void *body, size_t size);

/* Parses a packet. Returns false when it is malformed or of another version. The caller releases the head. */
bool packet_read(const void *data, size_t size, struct packet *packet);

/* Returns a non-negative integer of the head; 0 if missing. */
uint64_t packet_number(const struct packet *packet, const char *name);

#endif
