/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that are spoken elsewhere: daemons put them into queues, workers take them out. As in cluster.h,
 * an engine is a const table of functions; all belongs to the loop's thread, and no function waits. */
#ifndef FACCIA_CLUSTER_WORK_QUEUE_H
#define FACCIA_CLUSTER_WORK_QUEUE_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Voices that live workers speak. What is put into one queue sounds the same whoever takes it. */
struct work_source {
    const char *queue;  /* its name */
    const char *plugin; /* the name under which the world knows the voices */
    const char *voices; /* JSON, as a plugin describes itself (wire.h, WIRE_HELLO) */
};

enum work_turn { WORK_URGENT, WORK_USUAL, WORK_AHEAD, WORK_TURNS };

/* How a sentence ended. */
enum work_end {
    WORK_SPOKEN, /* the body is all that the voice said, as frames of wire.h; else it says why */
    WORK_FAILED,
    WORK_CRASHED,
    WORK_TIMEOUT,
    WORK_UNREACHED, /* no worker, or no way there */
    WORK_FULL,      /* too many wait */
    WORK_ENDS
};

/* ---- who asks ---- */

struct work;
struct work_task;

/* Once, never before work_put returns. */
typedef void (*work_answered)(void *ctx, enum work_end end, const struct buf *body);

/* Whose voices there are, now and then; good until it returns. */
typedef void (*work_seen)(void *ctx, const struct work_source *sources, size_t count);

struct work_engine {
    void (*watch)(struct work *work, work_seen seen, void *ctx);
    struct work_task *(*put)(struct work *work, const char *queue, enum work_turn turn, uint32_t payer,
                             const struct buf *sentence, work_answered answered, void *ctx);
    void (*cancel)(struct work_task *task);
    void (*close)(struct work *work);
};

/* The beginning of what an engine keeps. */
struct work {
    const struct work_engine *engine;
};
struct work_task {
    struct work *work;
};

/* seen NULL: nobody is told any more. The sentences of different payers come by turns; 0: this daemon's. */
void work_watch(struct work *work, work_seen seen, void *ctx);
struct work_task *work_put(struct work *work, const char *queue, enum work_turn turn, uint32_t payer,
                           const struct buf *sentence, work_answered answered, void *ctx);

/* No answer will come; who speaks it is told to stop. NULL is fine. */
void work_cancel(struct work_task *task);

/* After the last task was answered or cancelled. It is gone when the loop has run out. NULL is fine. */
void work_close(struct work *work);

/* ---- who speaks ---- */

struct work_consumer;
struct work_item;

/* How many of its sentences could be begun now: for somebody who hears them, and to be kept. */
struct work_offer {
    struct work_source source;
    unsigned live, ahead;
};

struct work_consumer_events {
    /* What is offered; asked again and again. Good until the next call. */
    size_t (*offers)(void *ctx, const struct work_offer **offers);
    /* A sentence to be spoken. The receiver answers it or gives it back. */
    void (*taken)(void *ctx, struct work_item *item);
    /* Somebody else has it by now, or nobody waits for it; it is gone when this returns. */
    void (*lost)(void *ctx, struct work_item *item);
};

struct work_consumer_engine {
    void (*look)(struct work_consumer *consumer);
    void (*answer)(struct work_item *item, enum work_end end, const struct buf *body);
    void (*give_back)(struct work_item *item);
    void (*close)(struct work_consumer *consumer);
};

struct work_consumer {
    const struct work_consumer_engine *engine;
};

struct work_item {
    struct work_consumer *consumer;
    const char *queue;
    enum work_turn turn;
    struct buf sentence;
    void *mine; /* the receiver's */
};

/* There is room again, or another offer. */
void work_consumer_look(struct work_consumer *consumer);

/* Both let the item go. Given back, it is spoken by whoever has room next. */
void work_answer(struct work_item *item, enum work_end end, const struct buf *body);
void work_give_back(struct work_item *item);

/* After the last item. NULL is fine. */
void work_consumer_close(struct work_consumer *consumer);

enum {
    WORK_VISIBLE_MS = 3000,  /* a worker of which nothing was heard for so long has lost its sentence */
    WORK_ANNOUNCE_MS = 4000, /* and its voices are no longer there */
    WORK_LOOK_MS = 1000,     /* so often daemons look, and workers say that they are there */
    WORK_TIMES = 3,          /* that a sentence is begun: it may be what the workers die of */
    WORK_BODY_MOST = 256 << 20,
};

#endif
