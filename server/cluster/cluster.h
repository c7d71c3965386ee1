/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cache of values that daemons share, so that each value is made once. An engine is one const table of
 * functions: callers see this header alone, so an engine other than Redis needs no change in them.
 * Everything runs in the loop's thread; no function blocks. */
#ifndef FACCIA_CLUSTER_CLUSTER_H
#define FACCIA_CLUSTER_CLUSTER_H

#include "server/base/buf.h"
#include <stdbool.h>

struct cluster;
struct cluster_ask;

/* The answer: the value of the key, valid until the callback returns. NULL: not cached and not claimed by
 * another daemon that is known, so the caller makes the value. Called once, never before cluster_ask
 * returns. */
typedef void (*cluster_answered)(void *ctx, const struct buf *value);

struct cluster_engine {
    bool (*up)(const struct cluster *cluster);
    struct cluster_ask *(*ask)(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                               void *ctx);
    void (*forget)(struct cluster_ask *ask);
    void (*making)(struct cluster *cluster, const struct buf *key);
    void (*give)(struct cluster *cluster, const struct buf *key, const struct buf *value);
    void (*close)(struct cluster *cluster);
};

/* Common header of every engine's state. */
struct cluster {
    const struct cluster_engine *engine;
};

/* Common header of every engine's query. */
struct cluster_ask {
    struct cluster *cluster;
};

/* Returns whether the cluster answers. While it does not, each daemon uses its own cache. False for NULL. */
bool cluster_up(const struct cluster *cluster);

/* Queries a key. If another daemon is making the value, the answer comes when that daemon delivers it,
 * gives up or dies. Call only while the cluster is up; if it goes down meanwhile, the answer is NULL. */
struct cluster_ask *cluster_ask(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                                void *ctx);

/* Cancels a query: no answer will come. */
void cluster_forget(struct cluster_ask *ask);

/* Renews the claim of a caller that was answered NULL: call repeatedly while making the value. Other
 * daemons wait CLUSTER_MAKING_MS after each call. */
void cluster_making(struct cluster *cluster, const struct buf *key);

/* Delivers the value and ends the claim. NULL: the caller gives up. */
void cluster_give(struct cluster *cluster, const struct buf *key, const struct buf *value);

/* Call after the last query has been answered or cancelled. Frees the cluster once the loop has run out of
 * its handles. NULL is allowed. */
void cluster_close(struct cluster *cluster);

enum {
    CLUSTER_CLAIM_MS =
        400, /* after NULL, call cluster_making within this time, or another daemon may claim the key */
    CLUSTER_WAIT_MS = 10000,  /* longest wait for another daemon's value, after which the caller makes it */
    CLUSTER_MAKING_MS = 2000, /* how long each call of cluster_making holds the claim */
};

#endif
