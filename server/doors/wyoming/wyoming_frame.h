/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Events of the Wyoming protocol (github.com/OHF-Voice/wyoming): a line of JSON with a type, then data_length
 * bytes of JSON, then payload_length bytes. */
#ifndef FACCIA_DOORS_WYOMING_FRAME_H
#define FACCIA_DOORS_WYOMING_FRAME_H

#include "server/base/buf.h"
#include <jansson.h>

enum { FRAME_LINE_MOST = 65536, FRAME_DATA_MOST = 1 << 20, FRAME_PAYLOAD_MOST = 1 << 22 };

struct frame {
    json_t *head; /* owns the type */
    json_t *data; /* of the line and what follows it */
    const char *type;
};

/* The next whole event of what has come, which is taken from it; its payload is passed over. 1; 0: it has not
 * come whole; -1: these are no events, *why says so. */
int frame_next(struct buf *come, struct frame *frame, const char **why);
void frame_free(struct frame *frame);

/* Adds an event; data is released. */
void frame_write(struct buf *out, const char *type, json_t *data, const void *payload, size_t size);

#endif
