/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the side that speaks: what it holds, and what it says to Redis. */
#ifndef FACCIA_CLUSTER_REDIS_HANDS_INTERNAL_H
#define FACCIA_CLUSTER_REDIS_HANDS_INTERNAL_H

#include "server/cluster/redis_names.h"
#include "server/cluster/redis_work.h"
#include "server/cluster/redis_work_link.h"
#include "server/cluster/work_pack.h"

enum { TO_MOST = 128 };

struct redis_item {
    struct work_item item;
    struct redis_item *prev, *next;
    char name[WORK_TASK_BYTES]; /* "KEY ID" */
    char key[WORK_TASK_BYTES], id[64], to[TO_MOST], queue[72];
    unsigned times;
};

struct redis_hands {
    struct work_hands hands;
    uv_loop_t *loop;
    struct redis_link *mouth, *ear;
    uv_timer_t pulse;
    struct work_hands_events events;
    void *ctx;
    struct redis_item *items;
    char id[REDIS_ID_BYTES], bell[64]; /* the last entry of the bell that was heard */
    size_t cursor;                     /* the offer that is taken from; */
    char queue[72];                    /* its queue */
    bool taking, again, listening, closed;
};

/* Takes what there is room for; called again while it is at it, it begins anew. */
void redis_hands_take(struct redis_hands *h);

/* Sends the answer, in pieces, and lets the item go. */
void redis_hands_answer(struct redis_item *item, enum work_end end, const struct buf *body);
void redis_hands_free_item(struct redis_item *item);

#endif
