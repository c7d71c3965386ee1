/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the side that asks: its sentences, and its way to Redis. */
#ifndef FACCIA_CLUSTER_REDIS_WORK_INTERNAL_H
#define FACCIA_CLUSTER_REDIS_WORK_INTERNAL_H

#include "server/cluster/redis_work.h"
#include "server/cluster/redis_work_link.h"
#include "server/cluster/redis_work_sources.h"
#include "server/cluster/work_pack.h"

enum { NUMBER_BYTES = 16, TO_BYTES = 64 };

struct redis_task {
    struct work_task task;
    struct redis_task *prev, *next;
    char name[WORK_TASK_BYTES]; /* "KEY ID"; "": Redis has not said it yet */
    work_answered answered;     /* NULL: cancelled */
    void *ctx;
    char attempt[WORK_ATTEMPT_BYTES]; /* whose answer has begun to come */
    unsigned pieces, missed;
    struct buf body;
    enum work_end failed; /* WORK_SPOKEN: not yet */
};

struct redis_work {
    struct work work;
    uv_loop_t *loop;
    struct redis_link *mouth, *ear; /* what is sent; where answers are waited for */
    uv_timer_t look, soon;
    struct redis_task *tasks;
    struct work_sources sources;
    work_seen seen;
    void *seen_ctx;
    char to[TO_BYTES], most[NUMBER_BYTES];
    unsigned lane;  /* of sentences that are nobody's */
    uint64_t heard; /* loop time: the sources are of then */
    struct metrics *metrics;
    double live, ahead; /* as the metrics have them */
    unsigned handles;
    bool listening; /* an answer is waited for */
    bool closed;
};

/* redis_work_tasks.c */
struct work_task *redis_task_put(struct work *work, const char *queue, enum work_turn turn, uint32_t payer,
                                 const struct buf *sentence, work_answered answered, void *ctx);
void redis_task_cancel(struct work_task *task);
bool redis_task_piece(struct redis_work *w, const void *data,
                      size_t size);                                   /* of an answer; false: it is none */
void redis_tasks_miss(struct redis_work *w, const redisReply *names); /* they are not in the queue */
void redis_tasks_fail(struct redis_work *w);                          /* Redis has gone */
void redis_tasks_on_soon(uv_timer_t *timer);

#endif
