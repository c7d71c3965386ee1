/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A connection to a Redis server that reconnects whenever it is lost. It is up from the answer to the
 * first PING; a server that does not answer for LINK_PATIENCE_MS is treated as lost. */
#ifndef FACCIA_CLUSTER_REDIS_LINK_H
#define FACCIA_CLUSTER_REDIS_LINK_H

#include "server/cluster/redis_address.h"
#include <hiredis/hiredis.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>
#include <uv.h>

struct redis_link;

enum { LINK_PATIENCE_MS = 500, LINK_PULSE_MS = 250, LINK_AGAIN_MS = 100, LINK_AGAIN_MOST_MS = 2000 };

/* An argument of a command: any bytes. */
struct link_text {
    const void *data;
    size_t size;
};

static inline struct link_text link_text_of(const char *text) {
    return (struct link_text){text, strlen(text)};
}

/* reply is valid until the callback returns; NULL: the connection was lost before the answer came. */
typedef void (*link_answered)(void *ctx, const redisReply *reply);

/* Opens a link; takes ownership of the address. changed is called when the link comes up, and when it is
 * lost. */
struct redis_link *redis_link_open(uv_loop_t *loop, struct redis_address *address,
                                   void (*changed)(void *ctx, bool up), void *ctx);
bool redis_link_up(const struct redis_link *link);

/* Makes the link a subscriber; call right after redis_link_open. The link then only listens to the channel
 * (Redis accepts no other commands on such a connection), and is up while it is subscribed. */
void redis_link_hear(struct redis_link *link, const char *channel,
                     void (*heard)(void *ctx, const void *data, size_t size), void *ctx);

/* Sends a command; answered may be NULL. Returns false, and calls no callback, when the link is not up. */
bool redis_link_send(struct redis_link *link, const struct link_text *words, int count,
                     link_answered answered, void *ctx);

/* Writes pending commands now, as far as the kernel accepts them, instead of at the end of the loop's
 * turn. This may lose the link. */
void redis_link_flush(struct redis_link *link);

/* Closes the link; pending commands get NULL. Frees it once the loop has run out of its handles. */
void redis_link_close(struct redis_link *link);

#endif
