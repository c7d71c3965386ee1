/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose voices there are, as Redis says: a list with how long each queue is, and the voices of each queue,
 * which are asked for once. */
#ifndef FACCIA_CLUSTER_REDIS_WORK_SOURCES_H
#define FACCIA_CLUSTER_REDIS_WORK_SOURCES_H

#include "server/cluster/redis_link.h"
#include "server/cluster/work_queue.h"

struct known_voices;

/* All zero at the start. */
struct work_sources {
    struct work_source *list; /* those whose voices are known */
    size_t count, cap;
    struct known_voices *known;
};

/* Reads the first half of SCRIPT_WORK_LOOK's answer, and asks for what is missing. The counts are of all
 * queues. */
void work_sources_read(struct work_sources *sources, const redisReply *reply, struct redis_link *link,
                       double *live, double *ahead);
/* The link is closed by then. */
void work_sources_free(struct work_sources *sources);

#endif
