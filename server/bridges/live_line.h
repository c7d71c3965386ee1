/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stream to the daemon (protocol/README.md, "WebSocket"): JSON in both directions, sound to the daemon.
 */
#ifndef FACCIA_BRIDGES_LIVE_LINE_H
#define FACCIA_BRIDGES_LIVE_LINE_H

#include "server/bridges/bridge.h"
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct live_line;

/* Callbacks; they must not close the line. */
struct live_line_calls {
    void (*message)(void *ctx, const json_t *message);
    void (*lost)(void *ctx, const char *why); /* last call */
};

/* Waits for the connection; members: of the query. NULL after a message that begins with `program`. */
struct live_line *live_line_open(uv_loop_t *loop, const char *program, const struct daemon_address *place,
                                 const struct remote_member *members, const struct live_line_calls *calls,
                                 void *ctx);

/* Run the loop until it is empty before freeing the line. */
void live_line_close(struct live_line *line);
void live_line_free(struct live_line *line);

/* Sends a message; takes ownership. */
void live_line_tell(struct live_line *line, json_t *message);
void live_line_sound(struct live_line *line, const void *bytes, size_t size);

/* Bytes that wait to be sent. */
size_t live_line_unsent(const struct live_line *line);

#endif
