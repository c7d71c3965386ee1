/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pool's public face: plugins found in a folder, their queues of sentences, the life of a job. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/pool_parts.h"
#include <dirent.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A sentence above this would not fit a frame. */
enum { TEXT_BYTES_MAX = WIRE_PAYLOAD_MAX / 4 };

static void push(struct job_queue *queue, struct voice_job *job) {
    job->queue = queue;
    if (queue->last)
        queue->last->next = job;
    else
        queue->first = job;
    queue->last = job;
}

static void take_out(struct voice_job *job) {
    struct job_queue *queue = job->queue;
    struct voice_job **at = &queue->first, *before = NULL;
    while (*at != job) {
        before = *at;
        at = &before->next;
    }
    *at = job->next;
    if (queue->last == job)
        queue->last = before;
    job->next = NULL;
    job->queue = NULL;
}

/* First come, first served. Fairness between clients would be decided here. */
struct voice_job *pool_next_job(struct plugin *plugin) {
    struct voice_job *job = plugin->waiting.first;
    if (job)
        take_out(job);
    return job;
}

static void free_job(struct voice_job *job) {
    assembly_free(job->assembly);
    plan_free(&job->plan);
    buf_free(&job->key);
    buf_free(&job->spoken);
    free(job);
}

void pool_job_end(struct voice_job *job, struct utterance *u, const struct error *e) {
    const struct voice_callbacks callbacks = job->callbacks;
    void *ctx = job->ctx;
    bool cancelled = job->cancelled;
    free_job(job);
    if (cancelled)
        utterance_free(u);
    else if (u)
        callbacks.done(ctx, u);
    else
        callbacks.failed(ctx, e);
}

static void queue_job(struct voice_job *job) {
    push(&job->plugin->waiting, job);
    for (size_t i = 0; i < job->plugin->worker_count && !job->worker; i++)
        worker_wake(&job->plugin->workers[i]);
}

static void fail_all(struct job_queue *queue, const char *code, const char *why) {
    while (queue->first) {
        struct voice_job *job = queue->first;
        struct error e;
        error_set(&e, code, "the voice %s %s", job->plugin->name, why);
        take_out(job);
        pool_job_end(job, NULL, &e);
    }
}

void pool_fail_waiting(struct plugin *plugin) {
    fail_all(&plugin->waiting, "voice-failed", "does not run");
}

static bool runs(const struct plugin *plugin) {
    for (size_t i = 0; i < plugin->worker_count; i++)
        if (!plugin->workers[i].given_up)
            return true;
    return false;
}

void pool_job_said(struct voice_job *job, const struct wire_frame *frame) {
    struct voice_cache *cache = job->plugin->pool->cache;
    if (!cache || job->uncacheable)
        return;
    if (job->spoken.size + frame->size + WIRE_HEADER_BYTES > cache_value_max(cache)) {
        job->uncacheable = true;
        buf_free(&job->spoken);
        return;
    }
    size_t place = wire_begin(&job->spoken, frame->type, 0);
    buf_add(&job->spoken, frame->data, frame->size);
    wire_end(&job->spoken, place);
}

void pool_job_spoken(struct voice_job *job) {
    struct voice_cache *cache = job->plugin->pool->cache;
    if (cache && !job->uncacheable && job->spoken.size)
        cache_put(cache, &job->key, &job->spoken);
}

/* Says again what the worker once said; a value that cannot be used (it lay on a disk) is spoken anew. */
static void recall(struct voice_job *job) {
    struct wire_frame frame;
    struct error e;
    size_t used;
    const uint8_t *at = job->spoken.data, *end = at + job->spoken.size;
    int state = 0;
    job->assembly = assembly_new(&job->plan);
    while (at < end && (state = wire_next(at, (size_t)(end - at), &frame, &used)) == 1) {
        if (frame.type == WIRE_AUDIO
                ? assembly_audio(job->assembly, &frame, &e)
                : frame.type != WIRE_EVENTS || assembly_events(job->assembly, &frame, &e))
            break;
        at += used;
    }
    if (at == end) {
        pool_job_end(job, assembly_finish(job->assembly, job->voice->lang, job->voice->sample_rate), NULL);
        return;
    }
    assembly_free(job->assembly);
    job->assembly = NULL;
    job->spoken.size = 0;
    if (runs(job->plugin))
        queue_job(job);
    else
        push(&job->plugin->pool->doomed, job);
}

static void on_soon(uv_timer_t *timer) {
    struct voice_pool *pool = timer->data;
    while (pool->known.first) {
        struct voice_job *job = pool->known.first;
        take_out(job);
        recall(job);
    }
    fail_all(&pool->doomed, "voice-failed", "does not run, or not for a sentence as long as this");
}

void pool_plugin_known(struct plugin *plugin) {
    struct voice_pool *pool = plugin->pool;
    bool all = true;
    for (size_t i = 0; i < pool->plugin_count; i++)
        all = all && pool->plugins[i].known;
    if (!all || pool->is_ready || pool->closing)
        return;
    pool->is_ready = true;
    if (pool->ready)
        pool->ready(pool->ready_ctx);
}

/* The plugin's own part of the configuration, as text. */
static char *config_of(const json_t *config, const char *name) {
    const json_t *own = json_object_get(config, name);
    char *text = json_is_object(own) ? json_dumps(own, JSON_COMPACT) : NULL;
    return text ? text : mem_strdup("{}");
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct plugin *)a)->name, ((const struct plugin *)b)->name);
}

static int find_plugins(struct voice_pool *pool, const struct voice_pool_options *options, struct error *e) {
    DIR *folder = opendir(options->plugin_dir);
    json_t *config = json_loads(options->config ? options->config : "{}", 0, NULL);
    size_t cap = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || dot == entry->d_name || strcmp(dot, ".so") != 0)
            continue;
        pool->plugins = mem_grow(pool->plugins, &cap, pool->plugin_count + 1, sizeof *pool->plugins);
        struct plugin *plugin = &pool->plugins[pool->plugin_count++];
        *plugin =
            (struct plugin){.pool = pool, .name = mem_strndup(entry->d_name, (size_t)(dot - entry->d_name))};
        plugin->config = config_of(config, plugin->name);
        plugin->path = mem_alloc(strlen(options->plugin_dir) + strlen(entry->d_name) + 2);
        sprintf(plugin->path, "%s/%s", options->plugin_dir, entry->d_name);
        struct stat file = {0};
        stat(plugin->path, &file);
        snprintf(plugin->edition, sizeof plugin->edition, "%lld.%09ld", (long long)file.st_mtim.tv_sec,
                 file.st_mtim.tv_nsec);
    }
    if (folder)
        closedir(folder);
    json_decref(config);
    if (!pool->plugin_count)
        return error_set(e, "voice-unavailable", "no voice plugin in \"%s\"", options->plugin_dir);
    qsort(pool->plugins, pool->plugin_count, sizeof *pool->plugins, by_name);
    return 0;
}

static void free_pool(struct voice_pool *pool) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        free(pool->plugins[i].name);
        free(pool->plugins[i].path);
        free(pool->plugins[i].config);
        free(pool->plugins[i].workers);
    }
    free(pool->plugins);
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
    pool->metrics = options->metrics;
    pool->retry_after = options->retry_after > 0 ? options->retry_after : 60;
    pool->quiet = options->quiet;
    pool->ready = ready;
    pool->ready_ctx = ctx;
    int result = 0;
    if (access(options->worker, X_OK) < 0)
        result = error_set(e, "voice-unavailable", "there is no worker program \"%s\"", options->worker);
    if (result < 0 || find_plugins(pool, options, e) < 0) {
        free_pool(pool);
        return NULL;
    }
    signal(SIGPIPE, SIG_IGN);
    pool->cache = cache_open(loop, &options->cache);
    uv_timer_init(loop, &pool->soon);
    pool->soon.data = pool;
    pool->open_handles = 1;
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        plugin->worker_count = options->workers ? options->workers : 1;
        plugin->workers = mem_alloc(plugin->worker_count * sizeof *plugin->workers);
        for (size_t k = 0; k < plugin->worker_count; k++)
            worker_open(&plugin->workers[k], plugin);
    }
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

static void on_soon_closed(uv_handle_t *handle) {
    pool_handle_closed(handle->data);
}

void voice_pool_close(struct voice_pool *pool, void (*closed)(void *ctx), void *ctx) {
    pool->closing = true;
    pool->closed = closed;
    pool->closed_ctx = ctx;
    uv_close((uv_handle_t *)&pool->soon, on_soon_closed);
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        for (size_t k = 0; k < plugin->worker_count; k++)
            worker_close(&plugin->workers[k]);
        fail_all(&plugin->waiting, "cancelled", "is shut down");
    }
    fail_all(&pool->doomed, "cancelled", "is shut down");
    fail_all(&pool->known, "cancelled", "is shut down");
    cache_close(pool->cache);
    pool->cache = NULL;
}

static struct plugin *plugin_of(struct voice_pool *pool, const struct voice *voice) {
    size_t i = 0;
    while (strcmp(pool->plugins[i].name, voice->plugin) != 0)
        i++;
    return &pool->plugins[i];
}

/* Makes the key: all that the worker is told, and which worker it is. True when the cache has the sentence.
 */
static bool look_up(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    const struct faccia_sentence sentence = {job->voice->id, job->plan.spans, job->plan.span_count};
    job->uncacheable = job->voice->capabilities & FACCIA_VOICE_FRESH;
    if (job->uncacheable)
        return false;
    wire_put_string(&job->key, job->plugin->edition);
    wire_put_string(&job->key, job->plugin->config);
    wire_put_sentence(&job->key, &sentence);
    const struct buf *value = cache_get(pool->cache, &job->key);
    metrics_add(pool->metrics, value ? METRIC_CACHE_HITS : METRIC_CACHE_MISSES, 1);
    if (value)
        buf_add(&job->spoken, value->data, value->size);
    return value != NULL;
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

struct voice_job *voice_pool_speak_plan(struct voice_pool *pool, const struct voice *voice, struct plan plan,
                                        const struct voice_callbacks *callbacks, void *ctx) {
    struct voice_job *job = mem_alloc(sizeof *job);
    job->plugin = plugin_of(pool, voice);
    job->number = ++pool->last_job ? pool->last_job : ++pool->last_job; /* 0 means none */
    job->voice = voice;
    job->callbacks = *callbacks;
    job->ctx = ctx;
    job->plan = plan;
    if (pool->cache && look_up(job))
        push(&pool->known, job);
    else if (!runs(job->plugin) || job->plan.text_bytes > TEXT_BYTES_MAX || pool->closing)
        push(&pool->doomed, job);
    if (!job->queue)
        queue_job(job);
    else if (!pool->closing)
        uv_timer_start(&pool->soon, on_soon, 0, 0);
    return job;
}

struct voice_job *voice_pool_speak(struct voice_pool *pool, const struct voice_request *request,
                                   const struct voice_callbacks *callbacks, void *ctx) {
    const struct plan_prosody prosody = voice_request_prosody(request, request->voice);
    struct plan plan;
    plan_make(&plan, request->score, request->sentence, &prosody);
    return voice_pool_speak_plan(pool, request->voice, plan, callbacks, ctx);
}

void voice_job_cancel(struct voice_job *job) {
    job->cancelled = true;
    if (job->worker) {
        worker_cancel(job->worker);
        return;
    }
    take_out(job);
    free_job(job);
}
