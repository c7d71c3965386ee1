/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A queue of sentences to be spoken elsewhere: daemons put them in, workers take them out. As in
 * cluster.h, an engine is one const table of functions; everything runs in the loop's thread, and no
 * function blocks. */
#ifndef FACCIA_CLUSTER_WORK_QUEUE_H
#define FACCIA_CLUSTER_WORK_QUEUE_H

#include "server/base/buf.h"
#include <stdbool.h>

/* The voices of live workers. A sentence in a queue sounds the same whichever worker takes it. */
struct work_source {
    const char *queue;  /* name of the queue */
    const char *plugin; /* public name of the voices */
    const char *voices; /* JSON, as a plugin describes itself (wire.h, WIRE_HELLO) */
};

enum work_turn { WORK_URGENT, WORK_USUAL, WORK_AHEAD, WORK_TURNS };

/* Result of a sentence. */
enum work_end {
    WORK_SPOKEN, /* the body is the voice's whole output, as frames of wire.h; otherwise it is the reason */
    WORK_FAILED,
    WORK_CRASHED,
    WORK_TIMEOUT,
    WORK_UNREACHED, /* no worker, or no connection */
    WORK_FULL,      /* the queue is full */
    WORK_ENDS
};

/* ---- requesting side ---- */

struct work;
struct work_task;

/* Called once, never before work_put returns. */
typedef void (*work_answered)(void *ctx, enum work_end end, const struct buf *body);

/* Reports the present sources from time to time; valid until the callback returns. */
typedef void (*work_seen)(void *ctx, const struct work_source *sources, size_t count);

struct work_engine {
    void (*watch)(struct work *work, work_seen seen, void *ctx);
    struct work_task *(*put)(struct work *work, const char *queue, enum work_turn turn, uint32_t quota_key,
                             const struct buf *sentence, work_answered answered, void *ctx);
    void (*cancel)(struct work_task *task);
    void (*close)(struct work *work);
};

/* Common header of every engine's state. */
struct work {
    const struct work_engine *engine;
};
struct work_task {
    struct work *work;
};

/* seen NULL: no callback. Sentences of different quota keys take turns; quota_key 0: this daemon. */
void work_watch(struct work *work, work_seen seen, void *ctx);
struct work_task *work_put(struct work *work, const char *queue, enum work_turn turn, uint32_t quota_key,
                           const struct buf *sentence, work_answered answered, void *ctx);

/* Cancels a sentence: no callback follows, and its worker is told to stop. NULL is allowed. */
void work_cancel(struct work_task *task);

/* Call after the last task was answered or cancelled. Frees the queue once the loop has run out of its
 * handles. NULL is allowed. */
void work_close(struct work *work);

/* ---- worker's side ---- */

struct work_consumer;
struct work_item;

/* The worker's free capacity for a source, in sentences: live ones, and ones made ahead for the cache. */
struct work_offer {
    struct work_source source;
    unsigned live, ahead;
};

struct work_consumer_events {
    /* The offers; called repeatedly. Valid until the next call. */
    size_t (*offers)(void *ctx, const struct work_offer **offers);
    /* A sentence to be spoken. The receiver answers it or gives it back. */
    void (*taken)(void *ctx, struct work_item *item);
    /* Another worker has taken the sentence, or it was cancelled. The item is freed when this returns. */
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
    void *mine; /* for the receiver's use */
};

/* Tells the consumer that the worker has room again, or other offers. */
void work_consumer_look(struct work_consumer *consumer);

/* Both free the item. A sentence given back goes to the next worker that has room. */
void work_answer(struct work_item *item, enum work_end end, const struct buf *body);
void work_give_back(struct work_item *item);

/* Call after the last item. NULL is allowed. */
void work_consumer_close(struct work_consumer *consumer);

enum {
    WORK_VISIBLE_MS = 3000,  /* a worker silent for this time loses its sentence */
    WORK_ANNOUNCE_MS = 4000, /* its voices expire after this time */
    WORK_LOOK_MS = 1000,     /* interval at which daemons look, and workers report */
    WORK_TIMES = 3,          /* attempts at a sentence: it may crash workers */
    WORK_BODY_MOST = 256 << 20,
};

#endif
