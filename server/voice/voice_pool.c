/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pool's public face: it is opened, speaks and is closed. */
#include "server/base/mem.h"
#include "server/voice/voice_cache_file.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A sentence above this would not fit a frame. */
enum { TEXT_BYTES_MAX = WIRE_PAYLOAD_MAX / 4 };

/* Sentences of the cache are given back for so long in one turn of the loop. */
enum { RECALL_US = 2000 };

static void on_soon(uv_timer_t *timer) {
    struct voice_pool *pool = timer->data;
    /* Each may be followed by another of the same text, at once: others have their turn on the loop, too. */
    uint64_t begin = uv_hrtime();
    for (struct voice_job *job;
         uv_hrtime() - begin < RECALL_US * 1000 && (job = job_take_next(&pool->known));)
        job_recall(job);
    /* Not at once: all timers that are due run before anything else does. */
    if (pool->known.first && !pool->closing)
        uv_timer_start(timer, on_soon, 1, 0);
    queue_fail(&pool->refused, ERROR_VOICE_FAILED, "does not run, or not for a sentence as long as this");
    pool_call_waits(pool);
}

void pool_soon(struct voice_pool *pool) {
    if (!pool->closing)
        uv_timer_start(&pool->soon, on_soon, 0, 0);
}

static void free_pool(struct voice_pool *pool) {
    plugins_free(pool);
    reserve_release(&pool->reserve);
    free(pool->worker_path);
    catalog_free(&pool->catalog);
    free(pool);
}

struct voice_pool *voice_pool_open(uv_loop_t *loop, const struct voice_pool_options *options,
                                   void (*ready)(void *ctx), void *ctx, struct error *e) {
    struct voice_pool *pool = mem_alloc(sizeof *pool);
    pool->loop = loop;
    pool->worker_path = mem_strdup(options->worker);
    pool->deadline_base = options->deadline_base > 0 ? options->deadline_base : 10;
    pool->deadline_per_byte = options->deadline_per_byte > 0 ? options->deadline_per_byte : 0.05;
    pool->deadline_most = options->deadline_most > 0 ? options->deadline_most : 10;
    pool->processor = options->processor > 0 ? options->processor : 20;
    pool->megabytes = options->megabytes ? options->megabytes : 4096;
    pool->unconfined = options->unconfined;
    pool->metrics = options->metrics;
    pool->retry_after = options->retry_after > 0 ? options->retry_after : 60;
    pool->boundaries = options->own_boundaries ? NULL : options->boundaries;
    pool->quiet = options->quiet;
    pool->ready = ready;
    pool->ready_ctx = ctx;
    int result = 0;
    if (access(options->worker, X_OK) < 0)
        result = error_set(e, ERROR_VOICE_UNAVAILABLE, "there is no worker program \"%s\"", options->worker);
    if (!result && options->cache.file && *options->cache.file)
        result = cache_file_check(options->cache.file, e);
    if (result < 0 || plugins_find(pool, options, e) < 0) {
        free_pool(pool);
        return NULL;
    }
    if (!pool->unconfined)
        private_memory();
    pool->cache = cache_open(loop, &options->cache);
    pool->cluster = options->cluster;
    pool->work = options->work;
    uv_timer_init(loop, &pool->soon);
    pool->soon.data = pool;
    pool->open_handles = 1;
    pool_start_open(pool, options->start_seconds);
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        plugin->worker_count = options->workers ? options->workers : 1;
        plugin->spare_count = options->spare_workers;
        plugin->seat_count =
            plugin->worker_count + (plugin->spare_count ? plugin->worker_count : 0) + plugin->spare_count;
        plugin->workers = mem_alloc(plugin->seat_count * sizeof *plugin->workers);
        for (size_t k = 0; k < plugin->seat_count; k++)
            worker_open(&plugin->workers[k], plugin);
    }
    pool_far_open(pool);
    return pool;
}

void pool_handle_closed(struct voice_pool *pool) {
    if (--pool->open_handles)
        return;
    void (*closed)(void *ctx) = pool->closed;
    void *ctx = pool->closed_ctx;
    free_pool(pool);
    if (closed)
        closed(ctx);
}

struct voice_list voice_pool_hold(struct voice_pool *pool) {
    pool->open_handles++;
    return (struct voice_list){pool->catalog.voices, pool->catalog.count};
}

void voice_pool_let_go(struct voice_pool *pool) {
    pool_handle_closed(pool);
}

static void on_soon_closed(uv_handle_t *handle) {
    pool_handle_closed(handle->data);
}

void voice_pool_close(struct voice_pool *pool, void (*closed)(void *ctx), void *ctx) {
    pool->closing = true;
    pool_far_close(pool);
    pool->closed = closed;
    pool->closed_ctx = ctx;
    uv_close((uv_handle_t *)&pool->soon, on_soon_closed);
    pool_start_close(pool);
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        for (size_t k = 0; k < plugin->seat_count; k++)
            worker_close(&plugin->workers[k]);
        queue_fail(&plugin->urgent, ERROR_CANCELLED, "is shut down");
        queue_fail(&plugin->waiting, ERROR_CANCELLED, "is shut down");
        queue_fail(&plugin->ahead, ERROR_CANCELLED, "is shut down");
    }
    queue_fail(&pool->refused, ERROR_CANCELLED, "is shut down");
    queue_fail(&pool->known, ERROR_CANCELLED, "is shut down");
    queue_fail(&pool->asked, ERROR_CANCELLED, "is shut down");
    cache_close(pool->cache);
    pool->cache = NULL;
    pool->cluster = NULL;
    pool->work = NULL;
}

/* There may be two of a name: one that does not run here, and one elsewhere. */
static struct plugin *plugin_of(struct voice_pool *pool, const struct voice *voice) {
    size_t i = 0;
    while (pool->plugins[i].name != voice->plugin)
        i++;
    return &pool->plugins[i];
}

struct plan_prosody voice_request_prosody(const struct voice_request *request, const struct voice *voice) {
    return (struct plan_prosody){
        .rate = request->rate,
        .own_rate = voice->rate,
        .pitch = request->pitch > 0 ? request->pitch : 1,
        .volume = request->volume > 0 ? request->volume : 1,
        .plays = voice->capabilities & FACCIA_VOICE_EMOTION,
    };
}

uint32_t pool_number(struct voice_pool *pool) {
    return ++pool->last_job ? pool->last_job : ++pool->last_job;
}

void job_begin(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    if (plugin_runs(job->plugin) && job->plan.text_bytes <= TEXT_BYTES_MAX && !pool->closing) {
        job_wait(job);
    } else {
        job_push(&pool->refused, job);
        pool_soon(pool);
    }
}

struct voice_job *voice_pool_speak_plan(struct voice_pool *pool, const struct voice *voice, struct plan plan,
                                        const struct voice_request *request,
                                        const struct voice_callbacks *callbacks, void *ctx) {
    struct voice_job *job = mem_alloc(sizeof *job);
    job->plugin = plugin_of(pool, voice);
    job->number = pool_number(pool);
    job->voice = voice;
    job->callbacks = *callbacks;
    job->ctx = ctx;
    job->plan = plan;
    job->turn = request->turn;
    job->payer = request->payer;
    job->asker = request->asker;
    if (job_look_up(job)) {
        job_push_in_turn(&pool->known, job);
        pool_soon(pool);
    } else {
        job_ask(job);
    }
    return job;
}

struct voice_job *voice_pool_speak(struct voice_pool *pool, const struct voice_request *request,
                                   const struct voice_callbacks *callbacks, void *ctx) {
    const struct plan_prosody prosody = voice_request_prosody(request, request->voice);
    struct plan plan;
    plan_make(&plan, request->score, request->sentence, &prosody);
    if (request->voice->capabilities & FACCIA_VOICE_CONTEXT) {
        const struct score_sentence *s = &request->score->sentences[request->sentence];
        plan_context(&plan, request->score, request->sentence, s->first, s->count);
    }
    return voice_pool_speak_plan(pool, request->voice, plan, request, callbacks, ctx);
}

void voice_job_cancel(struct voice_job *job) {
    job->cancelled = true;
    if (job->worker) {
        if (!job->gave_way && !job->too_long) /* else it is being stopped */
            worker_cancel(job->worker);
        return;
    }
    job_take_out(job);
    job_free(job);
}
