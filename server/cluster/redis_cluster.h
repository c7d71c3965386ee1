/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cluster's engine on Redis (7, or Valkey, which is compatible): a sentence is a string
 * faccia:{HASH}:speech that lives as long as keep_hours after it was last asked for; faccia:{HASH}:making, of
 * some milliseconds, is the name of the daemon that makes it. How much there is room for is Redis's own
 * setting (maxmemory, with allkeys-lru). */
#ifndef FACCIA_CLUSTER_REDIS_CLUSTER_H
#define FACCIA_CLUSTER_REDIS_CLUSTER_H

#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/cluster.h"
#include <uv.h>

struct redis_options {
    const char *address; /* redis_address.h */
    unsigned keep_hours;
    struct metrics *metrics; /* NULL: nobody counts */
};

/* Connects later, and again whenever it must. NULL with *e when the address is none. */
struct cluster *redis_cluster_open(uv_loop_t *loop, const struct redis_options *options, struct error *e);

#endif
