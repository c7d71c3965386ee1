/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A daemon's stream (protocol/README.md, "WebSocket"): JSON goes and comes, sound goes. */
#ifndef FACCIA_DOORS_LIVE_LINE_H
#define FACCIA_DOORS_LIVE_LINE_H

#include "server/doors/place.h"
#include <stdbool.h>

struct live_line;

struct live_line_calls {
    void (*message)(void *ctx, const json_t *message);
    void (*lost)(void *ctx, const char *why); /* nothing comes after it */
};

/* Waits until it is there. NULL after a message. The calls must not close it. */
struct live_line *live_line_open(uv_loop_t *loop, const struct place *place,
                                 const struct remote_member *members, const struct live_line_calls *calls,
                                 void *ctx);
/* The loop has to run until it has nothing to do before the line is freed. */
void live_line_close(struct live_line *line);
void live_line_free(struct live_line *line);

/* Takes the message. */
void live_line_tell(struct live_line *line, json_t *message);
void live_line_sound(struct live_line *line, const void *bytes, size_t size);
/* All of it has left. More than one piece of sound should not wait. */
bool live_line_is_free(const struct live_line *line);

#endif
