/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The side that asks: sentences go into the queue, their answers come back through a list of this daemon's
 * own. */
#include "server/base/mem.h"
#include "server/cluster/redis_names.h"
#include "server/cluster/redis_work_internal.h"
#include "server/cluster/redis_work_scripts.h"
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

static void listen_on(struct redis_work *w);

static void on_heard(void *ctx, const redisReply *reply) {
    struct redis_work *w = ctx;
    w->listening = false;
    if (!reply || w->closed)
        return;
    bool well = reply->type == REDIS_REPLY_NIL;
    if (reply->type == REDIS_REPLY_ARRAY && reply->elements == 2 &&
        reply->element[1]->type == REDIS_REPLY_STRING)
        well = redis_task_piece(w, reply->element[1]->str, (size_t)reply->element[1]->len);
    else
        redis_work_well(reply);
    if (well) /* otherwise from the next look on: nonsense that comes at once is not asked for at once */
        listen_on(w);
}

static void listen_on(struct redis_work *w) {
    char seconds[NUMBER_BYTES];
    snprintf(seconds, sizeof seconds, "0.%03d", WORK_LISTEN_MS);
    w->listening =
        w->listening ||
        redis_link_send(
            w->ear, (struct link_text[]){link_text_of("BLPOP"), link_text_of(w->to), link_text_of(seconds)},
            3, on_heard, w);
}

/* ---- what there is ---- */

static void set_metrics(struct redis_work *w, double live, double ahead) {
    metrics_add(w->metrics, METRIC_CLUSTER_QUEUE_LIVE, live - w->live);
    metrics_add(w->metrics, METRIC_CLUSTER_QUEUE_AHEAD, ahead - w->ahead);
    w->live = live;
    w->ahead = ahead;
}

static void tell(struct redis_work *w) {
    if (w->seen)
        w->seen(w->seen_ctx, w->sources.list, w->sources.count);
}

static void on_looked(void *ctx, const redisReply *reply) {
    struct redis_work *w = ctx;
    double live = 0, ahead = 0;
    if (!redis_work_well(reply) || w->closed || reply->type != REDIS_REPLY_ARRAY || reply->elements != 2)
        return;
    w->heard = uv_now(w->loop);
    work_sources_read(&w->sources, reply->element[0], w->mouth, &live, &ahead);
    set_metrics(w, live, ahead);
    redis_tasks_miss(w, reply->element[1]);
    tell(w);
}

static void on_look(uv_timer_t *timer) {
    struct redis_work *w = timer->data;
    struct redis_task *t;
    struct buf names = {0};
    listen_on(w);
    DL_FOREACH(w->tasks, t)
    if (*t->name && !t->failed)
        buf_printf(&names, "%s ", t->name);
    /* voices whose answers could not be heard are none */
    bool sent = redis_link_up(w->ear) &&
                redis_work_run(w->mouth, SCRIPT_WORK_LOOK,
                               (struct link_text[]){{names.data ? names.data : (uint8_t *)"", names.size}}, 1,
                               on_looked, w);
    buf_free(&names);
    if (!sent && w->sources.count && uv_now(w->loop) > w->heard + WORK_ANNOUNCE_MS) {
        w->sources.count = 0;
        set_metrics(w, 0, 0);
        tell(w);
        redis_tasks_fail(w);
    }
}

static void look_now(struct redis_work *w) {
    uv_timer_start(&w->look, on_look, 0, WORK_LOOK_MS);
}

static void on_mouth(void *ctx, bool up) {
    if (up)
        look_now(ctx);
    else
        redis_tasks_fail(ctx);
}

static void on_ear(void *ctx, bool up) {
    if (!up)
        return;
    listen_on(ctx);
    look_now(ctx);
}

static void watch(struct work *work, work_seen seen, void *ctx) {
    struct redis_work *w = (struct redis_work *)work;
    w->seen = seen;
    w->seen_ctx = ctx;
}

static void on_closed(uv_handle_t *handle) {
    struct redis_work *w = handle->data;
    if (--w->handles)
        return;
    work_sources_free(&w->sources);
    free(w);
}

/* The links end first: what they still wait for is answered meanwhile. */
static void close_work(struct work *work) {
    struct redis_work *w = (struct redis_work *)work;
    w->closed = true;
    w->seen = NULL;
    redis_link_close(w->mouth);
    redis_link_close(w->ear);
    uv_close((uv_handle_t *)&w->look, on_closed);
    uv_close((uv_handle_t *)&w->soon, on_closed);
}

static const struct work_engine engine = {watch, redis_task_put, redis_task_cancel, close_work};

struct work *redis_work_open(uv_loop_t *loop, const struct redis_work_options *options, struct error *e) {
    struct redis_work *w = mem_alloc(sizeof *w);
    char id[REDIS_ID_BYTES];
    w->work.engine = &engine;
    w->loop = loop;
    w->metrics = options->metrics;
    redis_id_make(id);
    snprintf(w->to, sizeof w->to, REDIS_WORK ":to:%s", id);
    w->lane = (unsigned)strtoul(id + REDIS_ID_BYTES - 9, NULL, 16);
    snprintf(w->most, sizeof w->most, "%u", options->most);
    w->mouth = redis_work_link(loop, options->address, "work", on_mouth, w, e);
    w->ear = w->mouth ? redis_work_link(loop, options->address, "answers", on_ear, w, e) : NULL;
    if (!w->ear) {
        free(w);
        return NULL;
    }
    uv_timer_init(loop, &w->look);
    uv_timer_init(loop, &w->soon);
    w->look.data = w->soon.data = w;
    w->handles = 2;
    uv_timer_start(&w->look, on_look, WORK_LOOK_MS, WORK_LOOK_MS);
    return &w->work;
}
