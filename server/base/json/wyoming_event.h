/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Events of the Wyoming protocol (github.com/OHF-Voice/wyoming): a line of JSON with a type, then data_length
 * bytes of JSON, then payload_length bytes. */
#ifndef FACCIA_BASE_JSON_WYOMING_EVENT_H
#define FACCIA_BASE_JSON_WYOMING_EVENT_H

#include "server/base/buf.h"
#include <jansson.h>

struct wyoming_event {
    json_t *head; /* owns the type */
    json_t *data; /* of the line and what follows it */
    const char *type;
    struct buf payload;
};

/* Takes the next complete event from the received bytes. Returns 1; 0 if it is incomplete; -1 with *why if
 * the bytes are invalid. */
int wyoming_event_next(struct buf *come, struct wyoming_event *event, const char **why);
void wyoming_event_free(struct wyoming_event *event);

/* Adds an event; data is released. */
void wyoming_event_write(struct buf *out, const char *type, json_t *data, const void *payload, size_t size);

#endif
