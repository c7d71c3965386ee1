/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formats what clients are sent, as JSON and as lines of text for people who type. */
#ifndef FACCIA_ROOMS_EVENTS_H
#define FACCIA_ROOMS_EVENTS_H

#include "server/base/buf.h"
#include "server/http/message_queue.h"
#include "server/stream/stream.h"
#include <jansson.h>

const char *event_name(enum stream_event_kind kind); /* the "type" of its message */

/* Appends a stream event as a JSON message or as a line. stream: the name of the stream. */
void event_write(struct buf *out, const struct stream_event *event, const char *stream);
void event_line(struct buf *line, const struct stream_event *event);

/* Appends any other message as a line; appends nothing when the message is of no use as text. */
void text_line(const json_t *message, struct buf *line);

/* Parses the JSON of a text message. Returns a new reference, or NULL. */
json_t *message_read(const struct queued_message *message);

#endif
