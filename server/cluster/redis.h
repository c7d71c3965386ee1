/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What daemons and workers share over a Redis server. */
#ifndef FACCIA_CLUSTER_REDIS_H
#define FACCIA_CLUSTER_REDIS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/board.h"
#include "server/cluster/bus.h"
#include "server/cluster/cluster.h"
#include "server/cluster/work_queue.h"
#include <uv.h>

/* The cluster's engine on Redis (7, or Valkey, which is compatible): a sentence is a string
 * faccia:{HASH}:speech that lives as long as keep_hours after it was last asked for; faccia:{HASH}:making, of
 * some milliseconds, is the name of the daemon that makes it. How much there is room for is Redis's own
 * setting (maxmemory, with allkeys-lru). */

struct redis_options {
    const char *address; /* redis_address.h */
    unsigned keep_hours;
    struct metrics *metrics; /* NULL: nobody counts */
};

/* Connects later, and again whenever it must. NULL with *e when the address is none. */
struct cluster *redis_cluster_open(uv_loop_t *loop, const struct redis_options *options, struct error *e);

/* The bus by a Redis server. A lease is a string faccia:lease:NAME of BUS_LEASE_MS with the holder's name and
 * its token, which comes from the counter faccia:token; each daemon subscribes to one channel,
 * faccia:to:NAME. What is sent under a lease goes through a script that looks who holds it. */

/* Connects later, and again whenever it must. metrics may be NULL. NULL with *e when the address
 * (redis_address.h) is none. */
struct bus *redis_bus_open(uv_loop_t *loop, const char *address, struct metrics *metrics, struct error *e);

/* The board in a Redis server. */

/* As redis_bus_open. */
struct board *redis_board_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                               struct error *e);

/* The work queue on Redis: streams with a consumer group; redis_work_scripts.h says what is kept where. */

struct redis_work_options {
    const char *address;     /* redis_address.h */
    unsigned most;           /* sentences in a queue, those that are being spoken included */
    struct metrics *metrics; /* NULL: nobody counts */
};

/* For who asks. Connects later, and again whenever it must. NULL with *e when the address is none. */
struct work *redis_work_open(uv_loop_t *loop, const struct redis_work_options *options, struct error *e);

/* For who speaks. */
struct work_consumer *redis_consumer_open(uv_loop_t *loop, const char *address,
                                          const struct work_consumer_events *events, void *ctx,
                                          struct error *e);

/* The names under which Redis keeps a sentence. */

enum { REDIS_NAME_BYTES = 96, REDIS_ID_BYTES = 33, REDIS_HASH_BYTES = 65 };

/* What is in braces lies on one server of a Redis cluster. */
struct redis_names {
    char value[REDIS_NAME_BYTES], claim[REDIS_NAME_BYTES];
};

/* SHA-256 of the key, in hexadecimal digits. */
void redis_hash_of(const struct buf *key, char hex[REDIS_HASH_BYTES]);

/* A name that no other daemon has. */
void redis_id_make(char id[REDIS_ID_BYTES]);

#endif
