/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/cluster.h"
#include <stddef.h>

bool cluster_up(const struct cluster *cluster) {
    return cluster && cluster->engine->up(cluster);
}

struct cluster_ask *cluster_ask(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                                void *ctx) {
    return cluster->engine->ask(cluster, key, answered, ctx);
}

void cluster_forget(struct cluster_ask *ask) {
    if (ask)
        ask->cluster->engine->forget(ask);
}

void cluster_making(struct cluster *cluster, const struct buf *key) {
    cluster->engine->making(cluster, key);
}

void cluster_give(struct cluster *cluster, const struct buf *key, const struct buf *value) {
    cluster->engine->give(cluster, key, value);
}

void cluster_close(struct cluster *cluster) {
    if (cluster)
        cluster->engine->close(cluster);
}
