/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bus by a Redis server. A lease is a string faccia:lease:NAME of BUS_LEASE_MS with the holder's name and
 * its token, which comes from the counter faccia:token; each daemon subscribes to one channel,
 * faccia:to:NAME. What is sent under a lease goes through a script that looks who holds it. */
#ifndef FACCIA_CLUSTER_REDIS_BUS_H
#define FACCIA_CLUSTER_REDIS_BUS_H

#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/bus.h"
#include <uv.h>

/* Connects later, and again whenever it must. metrics may be NULL. NULL with *e when the address
 * (redis_address.h) is none. */
struct bus *redis_bus_open(uv_loop_t *loop, const char *address, struct metrics *metrics, struct error *e);

#endif
