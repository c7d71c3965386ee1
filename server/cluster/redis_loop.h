/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A connection to a Redis server on a libuv loop. hiredis's own adapter changes what is polled at each
 * command and again when that has left, and with each change libuv forgets that the connection is readable,
 * until it has polled anew: a loop with something to send in each of its turns never reads an answer. This
 * one polls for answers all the time, and what is sent leaves together at the end of the turn, or before the
 * next poll.
 */
#ifndef FACCIA_CLUSTER_REDIS_LOOP_H
#define FACCIA_CLUSTER_REDIS_LOOP_H

#include <hiredis/async.h>
#include <uv.h>

/* For as long as the context lives. Not 0: the loop cannot poll it. */
int redis_loop_attach(redisAsyncContext *context, uv_loop_t *loop);

#endif
