/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The work queue on Redis: streams with a consumer group; redis_work_scripts.h says what is kept where. */
#ifndef FACCIA_CLUSTER_REDIS_WORK_H
#define FACCIA_CLUSTER_REDIS_WORK_H

#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/work_queue.h"
#include <uv.h>

struct redis_work_options {
    const char *address;     /* redis_address.h */
    unsigned most;           /* sentences in a queue, those that are being spoken included */
    struct metrics *metrics; /* NULL: nobody counts */
};

/* For who asks. Connects later, and again whenever it must. NULL with *e when the address is none. */
struct work *redis_work_open(uv_loop_t *loop, const struct redis_work_options *options, struct error *e);

/* For who speaks. */
struct work_hands *redis_hands_open(uv_loop_t *loop, const char *address,
                                    const struct work_hands_events *events, void *ctx, struct error *e);

#endif
