/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is told to clients, as JSON and as lines for people who type. */
#ifndef FACCIA_ROOMS_EVENTS_H
#define FACCIA_ROOMS_EVENTS_H

#include "server/base/buf.h"
#include "server/http/message_queue.h"
#include "server/stream/stream.h"
#include <jansson.h>

const char *event_name(enum stream_event_kind kind); /* its "type" */

/* Appends the event of that stream as a message, or as a line. */
void event_write(struct buf *out, const struct stream_event *event, const char *stream);
void event_line(struct buf *line, const struct stream_event *event);

/* Appends any other message as a line; nothing when it is of no use to people who type. */
void text_line(const json_t *message, struct buf *line);

/* What was sent in that text; a new reference, or NULL. */
json_t *message_read(const struct queued_message *message);

#endif
