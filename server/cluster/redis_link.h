/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to a Redis server, which is made anew whenever it is lost. It is up from the answer to the
 * first PING on; a server that does not answer for LINK_PATIENCE_MS is as good as gone. */
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

/* An argument: any bytes. */
struct link_text {
    const void *data;
    size_t size;
};

static inline struct link_text link_text_of(const char *text) {
    return (struct link_text){text, strlen(text)};
}

/* reply is good until it returns, and NULL when the connection was lost before the answer came. */
typedef void (*link_answered)(void *ctx, const redisReply *reply);

/* The link takes the address over. changed is called when it has come up, and when it is lost. */
struct redis_link *redis_link_open(uv_loop_t *loop, struct redis_address *address,
                                   void (*changed)(void *ctx, bool up), void *ctx);
bool redis_link_up(const struct redis_link *link);

/* Right after redis_link_open: the link does nothing but listen to that channel from then on (Redis takes no
 * other commands on such a connection), and is up while it does. */
void redis_link_hear(struct redis_link *link, const char *channel,
                     void (*heard)(void *ctx, const void *data, size_t size), void *ctx);

/* Sends a command; answered may be NULL. False, and no answer, when the link is not up. */
bool redis_link_send(struct redis_link *link, const struct link_text *words, int count,
                     link_answered answered, void *ctx);

/* What was sent leaves now, as far as the system takes it, and not when the loop comes to it. The link may be
 * lost by that. */
void redis_link_flush(struct redis_link *link);

/* What waits for an answer gets NULL. Freed when the loop has run out. */
void redis_link_close(struct redis_link *link);

#endif
