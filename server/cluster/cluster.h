/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What several daemons have in common. An engine is one const table of functions: callers see this header
 * alone, and another engine than Redis needs no change of theirs. All belongs to the loop's thread; no
 * function waits. */
#ifndef FACCIA_CLUSTER_CLUSTER_H
#define FACCIA_CLUSTER_CLUSTER_H

#include "server/base/buf.h"
#include <stdbool.h>

struct cluster;
struct cluster_ask;

/* The answer: the value of the key, good until the callback returns; or NULL: nobody has it, and nobody makes
 * it who can be known of, so that it is the asker's to make. Comes once, never before cluster_ask returns. */
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

/* The beginning of what an engine keeps. */
struct cluster {
    const struct cluster_engine *engine;
};

/* The beginning of what an engine keeps of a question. */
struct cluster_ask {
    struct cluster *cluster;
};

/* Does it answer? While it does not, each daemon goes on with what it has. False for NULL. */
bool cluster_up(const struct cluster *cluster);

/* Who asks for a key that another daemon is making is answered when that one gives the value, gives up or
 * dies. Only while it is up; when it goes meanwhile, the answer is NULL. */
struct cluster_ask *cluster_ask(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                                void *ctx);

/* No answer will come. */
void cluster_forget(struct cluster_ask *ask);

/* Who was answered NULL says so again and again while he makes the value (CLUSTER_MAKING_MS): the others wait
 * so long. */
void cluster_making(struct cluster *cluster, const struct buf *key);

/* At last he gives the value, or NULL: there will be none of his. */
void cluster_give(struct cluster *cluster, const struct buf *key, const struct buf *value);

/* After the last ask has been answered or forgotten. It is gone when the loop has run out. NULL is fine. */
void cluster_close(struct cluster *cluster);

enum {
    CLUSTER_CLAIM_MS = 400,   /* who was answered NULL begins within that time, or another may */
    CLUSTER_WAIT_MS = 10000,  /* who waits for another's value makes it by himself after that */
    CLUSTER_MAKING_MS = 2000, /* who makes it, and has said so, is believed for so long */
};

#endif
