/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Engines on a Redis server, shared by daemons and workers. */
#ifndef FACCIA_CLUSTER_REDIS_H
#define FACCIA_CLUSTER_REDIS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/bus.h"
#include "server/cluster/cluster.h"
#include "server/cluster/presence.h"
#include "server/cluster/work_queue.h"
#include <uv.h>

/* The cluster's engine on Redis (7, or the compatible Valkey). A sentence is a string faccia:{HASH}:speech
 * that expires keep_hours after its last query; faccia:{HASH}:making, which expires within seconds, holds
 * the name of the daemon that makes the sentence. Redis's own settings limit the memory (maxmemory, with
 * allkeys-lru). */

struct redis_options {
    const char *address; /* redis_address.h */
    unsigned keep_hours;
    struct metrics *metrics; /* NULL: no metrics */
};

/* Connects in the background, and again after each loss. Returns NULL with *e when the address is invalid. */
struct cluster *redis_cluster_open(uv_loop_t *loop, const struct redis_options *options, struct error *e);

/* The bus on a Redis server. A lease is a string faccia:lease:NAME, which expires after BUS_LEASE_MS and
 * holds the holder's name and its token, taken from the counter faccia:token. Each daemon subscribes to
 * one channel, faccia:to:NAME. Data sent under a lease goes through a script that checks the holder. */

/* Connects in the background, and again after each loss. metrics may be NULL. Returns NULL with *e when
 * the address (redis_address.h) is invalid. */
struct bus *redis_bus_open(uv_loop_t *loop, const char *address, struct metrics *metrics, struct error *e);

/* The store on a Redis server. */

/* As redis_bus_open. */
struct presence *redis_presence_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                                     struct error *e);

/* The work queue on Redis: streams with a consumer group; redis_work_internal.h documents the keys. */

struct redis_work_options {
    const char *address;     /* redis_address.h */
    unsigned most;           /* sentences in one queue, including those being spoken */
    struct metrics *metrics; /* NULL: no metrics */
};

/* Opens the requesting side. Connects in the background, and again after each loss. Returns NULL with *e
 * when the address is invalid. */
struct work *redis_work_open(uv_loop_t *loop, const struct redis_work_options *options, struct error *e);

/* Opens the worker's side, in the same way. */
struct work_consumer *redis_consumer_open(uv_loop_t *loop, const char *address,
                                          const struct work_consumer_events *events, void *ctx,
                                          struct error *e);

/* The keys of a sentence in Redis. */

enum { REDIS_NAME_BYTES = 96, REDIS_ID_BYTES = 33, REDIS_HASH_BYTES = 65 };

/* The part in braces puts both keys on the same server of a Redis cluster. */
struct redis_names {
    char value[REDIS_NAME_BYTES], claim[REDIS_NAME_BYTES];
};

/* SHA-256 of the key, in hexadecimal digits. */
void redis_hash_of(const struct buf *key, char hex[REDIS_HASH_BYTES]);

/* Makes a random name, unique among daemons. */
void redis_id_make(char id[REDIS_ID_BYTES]);

#endif
