/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What both sides of the work queue send. */
#ifndef FACCIA_CLUSTER_REDIS_WORK_LINK_H
#define FACCIA_CLUSTER_REDIS_WORK_LINK_H

#include "server/cluster/redis_link.h"

/* So long Redis holds back an answer while there is nothing to say; less than a link's patience. */
enum { WORK_LISTEN_MS = 200 };

/* A script of redis_work_scripts.h with its ARGV. False, and no answer, when the link is not up. */
bool redis_work_run(struct redis_link *link, const char *script, const struct link_text *more, int count,
                    link_answered answered, void *ctx);

/* A link whose log lines say what it is for. */
struct redis_link *redis_work_link(uv_loop_t *loop, const char *address, const char *what,
                                   void (*changed)(void *ctx, bool up), void *ctx, struct error *e);

/* Logs a reply that is an error. True when it is a reply, and none. */
bool redis_work_well(const redisReply *reply);

/* An element of an array as text; "" when it is none. */
const char *redis_work_text(const redisReply *array, size_t index);

#endif
