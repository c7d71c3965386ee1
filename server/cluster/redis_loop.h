/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A connection to a Redis server on a libuv loop. hiredis reads the replies; its asynchronous interface is
 * not used, since it asserts that a server sends nothing that was not asked for, and so lets a server end the
 * daemon. Each reply goes to the oldest question; one without a question, or of another shape than
 * reply_check.h allows, loses the connection.
 *
 * The socket is polled for answers all the time, and what is sent leaves together at the end of the loop's
 * turn: an adapter that changes what is polled at each command makes libuv forget that the socket is
 * readable, and a loop with something to send in each turn would never read an answer. */
#ifndef FACCIA_CLUSTER_REDIS_LOOP_H
#define FACCIA_CLUSTER_REDIS_LOOP_H

#include <hiredis/hiredis.h>
#include <sys/socket.h>
#include <uv.h>

struct redis_loop;
struct link_text;

struct redis_loop_events {
    void (*connected)(void *ctx);
    void (*lost)(void *ctx, const char *why); /* once; it is to be closed then */
};

/* NULL: errno says why. */
struct redis_loop *redis_loop_open(uv_loop_t *loop, const struct sockaddr *to, socklen_t size,
                                   const struct redis_loop_events *events, void *ctx);

/* Sends a command. answered may be NULL; the reply that it gets is good until it returns, and NULL when the
 * connection is closed before. */
void redis_loop_ask(struct redis_loop *connection, const struct link_text *words, int count,
                    void (*answered)(void *ctx, const redisReply *reply), void *ctx);

/* Sends a command after which replies come without further questions, to heard. */
void redis_loop_hear(struct redis_loop *connection, const struct link_text *words, int count,
                     void (*heard)(void *ctx, const redisReply *reply), void *ctx);

/* What was sent leaves now, as far as the system takes it. The connection may be lost by that. */
void redis_loop_flush(struct redis_loop *connection);

/* All questions get NULL. */
void redis_loop_close(struct redis_loop *connection);

#endif
