/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One seat for a worker process: starts it, watches the clock, starts it anew when it is lost. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/far_process.h"
#include "server/voice/voice_pool_internal.h"
#include "server/voice/worker_process.h"
#include <stdlib.h>
#include <string.h>

enum {
    START_MS = 30000, /* to say hello: a neural voice loads its weights */
    REST_MS = 100,    /* before the second start in a row; doubled for each further one */
    STARTS = 5,       /* in a row, before the plugin is given up for a while */
    SHORT_MS = 100,   /* before the next try to start, when the system has no room for a process */
    SHORT_LOG_MS = 1000,
    PROCESSOR_SECONDS_MAX = 1 << 30,
};

static void start(struct worker *w);

static void on_time(uv_timer_t *timer);

void worker_set_state(struct worker *w, enum worker_state state, uint64_t ms) {
    w->state = state;
    if (ms)
        uv_timer_start(&w->timer, on_time, ms, 0);
    else
        uv_timer_stop(&w->timer);
}

/* Ends the sentence that is spoken. */
void worker_end_job(struct worker *w, struct sentence_audio *u, const struct error *e) {
    struct voice_job *job = w->job;
    w->job = NULL;
    if (job)
        pool_job_end(job, u, e);
}

static void give_up(struct worker *w, const char *why) {
    struct plugin *plugin = w->plugin;
    if (w->absent && !plugin->known && !plugin->absence)
        plugin->absence = mem_strdup(why);
    if (!w->given_up && !w->absent)
        log_error("the voice %s does not start: %s; it will be tried again every %.0f s", plugin->name, why,
                  plugin->pool->retry_after);
    w->given_up = true;
    worker_set_state(w, WORKER_RESTING, (uint64_t)(plugin->pool->retry_after * 1000) + 1);
    if (plugin_runs(plugin))
        return;
    plugin->known = true;
    pool_fail_waiting(plugin);
    pool_plugin_known(plugin);
}

static void turn_off(struct worker *w, uint64_t rest_ms) {
    w->not_before = uv_now(w->plugin->pool->loop) + rest_ms;
    worker_set_state(w, WORKER_OFF, 0);
}

/* A start that came to nothing: the next one comes later, and much later after several. */
static void rest(struct worker *w, const char *why, bool hopeless) {
    w->failed_starts++;
    if (w->spare)
        turn_off(w, (uint64_t)REST_MS << (w->failed_starts < STARTS ? w->failed_starts : STARTS));
    else if (hopeless || w->failed_starts >= STARTS || w->given_up)
        give_up(w, why);
    else
        worker_set_state(w, WORKER_RESTING, (uint64_t)REST_MS << (w->failed_starts - 1));
}

/* The process is lost; why follows "the voice NAME". That costs the sentence that it spoke, if any, and
 * another process is started: at once if this one was of any use. */
void worker_lose(struct worker *w, enum error_code code, const char *why, bool hopeless) {
    struct plugin *plugin = w->plugin;
    enum worker_state state = w->state;
    struct error e;
    if (plugin->pool->closing)
        return;
    if (w->process)
        process_stop(w->process, hopeless); /* one that has said why it ends is about to */
    w->process = NULL;
    error_set(&e, w->job && w->job->gave_way ? ERROR_CANCELLED : code, "the voice %s %s", plugin->name, why);
    if (state == WORKER_IDLE || state == WORKER_SPEAKING || state == WORKER_LOST)
        log_warn("the voice %s %s; it is started again", plugin->name, why);
    w->state = WORKER_RESTING;
    if (state == WORKER_IDLE || state == WORKER_STARTING || state == WORKER_RESTING)
        rest(w, why, hopeless);
    else if (w->spare && spare_may_go(plugin))
        turn_off(w, 0);
    else
        start(w);
    worker_end_job(w, NULL, &e);
}

static void on_time(uv_timer_t *timer) {
    struct worker *w = timer->data;
    switch (w->state) {
    case WORKER_STARTING:
        worker_lose(w, ERROR_VOICE_FAILED, "does not answer", false);
        break;
    case WORKER_SPEAKING:
        worker_lose(w, ERROR_VOICE_TIMEOUT, "took too long", false);
        break;
    case WORKER_STOPPING:
        worker_lose(w, ERROR_VOICE_TIMEOUT, "did not stop", false);
        break;
    case WORKER_LOST:
        worker_lose(w, ERROR_VOICE_TIMEOUT, "did not come back", false);
        break;
    case WORKER_RESTING:
        start(w);
        break;
    case WORKER_IDLE:
        worker_retire(w);
        break;
    case WORKER_OFF:
        break;
    }
}

static void hello(struct worker *w, const char *description) {
    struct plugin *plugin = w->plugin;
    struct error e;
    if (plugin->aside.count && !plugin->listed) {
        catalog_put_back(&plugin->pool->catalog, plugin->aside);
    } else if (!plugin->listed || w->given_up) {
        if (catalog_add(&plugin->pool->catalog, plugin->name, description, &e) < 0) {
            worker_lose(w, e.code, e.message, true);
            return;
        }
    }
    plugins_tell_gaps(plugin->pool, description);
    if (!plugin->description)
        plugin->description = mem_strdup(description);
    if (w->given_up)
        log_info("the voice %s has started after all", plugin->name);
    w->given_up = false;
    worker_set_state(w, WORKER_IDLE, 0);
    plugin->known = plugin->listed = true;
    pool_plugin_known(plugin);
    worker_wake(w);
}

/* The first thing a process says. */
void worker_greeted(struct worker *w, const struct wire_frame *frame) {
    struct wire_reader r = wire_read(frame);
    const char *text = wire_get_string(&r);
    w->absent = text && frame->type == WIRE_ABSENT;
    if (text && frame->type == WIRE_HELLO)
        hello(w, text);
    else
        worker_lose(w, ERROR_VOICE_FAILED,
                    text && (w->absent || frame->type == WIRE_FAILED) ? text : "sent garbage", true);
}

static void died(void *ctx, const char *how) {
    worker_lose(ctx, ERROR_VOICE_CRASHED, how, false);
}

static void gone(void *ctx) {
    struct worker *w = ctx;
    pool_handle_closed(w->plugin->pool);
}

/* For something that should be done after so many ms. */
uint32_t worker_processor_seconds(const struct voice_pool *pool, uint64_t ms) {
    double seconds = pool->processor * (double)ms / 1000;
    return seconds < PROCESSOR_SECONDS_MAX ? (uint32_t)seconds : PROCESSOR_SECONDS_MAX;
}

/* No fault of the plugin's: its sentences wait. */
static void wait_for_room(struct worker *w, const char *why) {
    struct voice_pool *pool = w->plugin->pool;
    uint64_t now = uv_now(pool->loop);
    if (now >= pool->short_logged + SHORT_LOG_MS || !pool->short_logged) {
        log_warn("the voice %s has to wait: %s", w->plugin->name, why);
        pool->short_logged = now;
    }
    worker_set_state(w, WORKER_RESTING, SHORT_MS);
}

/* With the reserve, when there is nothing else. */
static struct process *launch(struct worker *w, struct error *e) {
    static const struct process_callbacks callbacks = {worker_said, died, gone};
    struct voice_pool *pool = w->plugin->pool;
    struct process *process = NULL;
    if (w->plugin->queue) {
        pool->open_handles++;
        return far_process_start(pool->loop, pool->work, w->plugin->queue, w->plugin->description, &callbacks,
                                 w);
    }
    reserve_fill(&pool->reserve);
    for (int i = 0; i < 2 && !process; i++) {
        pool->open_handles++;
        process = process_start(pool->loop, pool->worker_path, w->plugin->path, &callbacks, w, e);
        if (!process && e->code != PROCESS_NO_ROOM)
            break;
        if (!process)
            reserve_release(&pool->reserve);
    }
    reserve_fill(&pool->reserve);
    return process;
}

static void start(struct worker *w) {
    struct plugin *plugin = w->plugin;
    struct voice_pool *pool = plugin->pool;
    const struct wire_limits limits = {pool->megabytes, worker_processor_seconds(pool, START_MS),
                                       !pool->unconfined};
    struct error e;
    worker_set_state(w, WORKER_STARTING, START_MS);
    w->process = launch(w, &e);
    if (!w->process && e.code == PROCESS_NO_ROOM) {
        wait_for_room(w, e.message);
        return;
    }
    if (!w->process) {
        worker_lose(w, e.code, e.message, false);
        return;
    }
    struct buf b = {0};
    size_t place = wire_begin(&b, WIRE_OPEN, 0);
    wire_put_string(&b, plugin->config);
    wire_put_limits(&b, &limits);
    wire_end(&b, place);
    process_send(w->process, &b);
    buf_free(&b);
}

void worker_open(struct worker *w, struct plugin *plugin) {
    w->plugin = plugin;
    w->timer.data = w->pulse.data = w;
    uv_timer_init(plugin->pool->loop, &w->timer);
    uv_timer_init(plugin->pool->loop, &w->pulse);
    plugin->pool->open_handles += 2;
    w->spare = w >= plugin->workers + plugin->worker_count;
    w->given_up = plugin->queue; /* until somebody is there */
    if (plugin->queue)
        w->state = WORKER_RESTING;
    else if (w->spare)
        turn_off(w, 0);
    else
        start(w);
}

void worker_begin(struct worker *w) {
    w->given_up = false;
    start(w);
}

void worker_leave(struct worker *w, const char *why) {
    struct error e;
    if (w->process)
        process_stop(w->process, false);
    w->process = NULL;
    w->given_up = true;
    worker_set_state(w, WORKER_RESTING, 0);
    error_set(&e, ERROR_VOICE_UNAVAILABLE, "the voice %s %s", w->plugin->name, why);
    worker_end_job(w, NULL, &e);
}

void worker_start(struct worker *w) {
    start(w);
}

void worker_retire(struct worker *w) {
    if (!spare_may_go(w->plugin)) {
        worker_set_state(w, WORKER_IDLE, WORKER_RETIRE_MS);
        return;
    }
    process_stop(w->process, true);
    w->process = NULL;
    turn_off(w, 0);
}

static void on_timer_closed(uv_handle_t *handle) {
    struct worker *w = handle->data;
    pool_handle_closed(w->plugin->pool);
}

void worker_close(struct worker *w) {
    struct error e;
    bool idle = w->state == WORKER_IDLE;
    uv_close((uv_handle_t *)&w->timer, on_timer_closed);
    uv_close((uv_handle_t *)&w->pulse, on_timer_closed);
    if (w->process)
        process_stop(w->process, idle);
    w->process = NULL;
    error_set(&e, ERROR_CANCELLED, "the voice %s is shut down", w->plugin->name);
    worker_end_job(w, NULL, &e);
}
