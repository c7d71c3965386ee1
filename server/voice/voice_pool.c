/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pool: finding plugins, startup, opening and closing. */
#include "server/base/buf.h"
#include "server/base/etag.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_cache.h"
#include "server/voice/voice_pool_internal.h"
#include <dirent.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Returns the plugin's part of the configuration as text. */
static char *config_of(const json_t *config, const char *name) {
    const json_t *own = json_object_get(config, name);
    char *text = json_is_object(own) ? json_dumps(own, JSON_COMPACT) : NULL;
    return text ? text : mem_strdup("{}");
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct plugin *)a)->name, ((const struct plugin *)b)->name);
}

enum { PLUGIN_BYTES_MAX = 64 << 20 };

/* Hash of the file's content: the same on every machine. */
static void edition_of(const char *path, char edition[ETAG_BYTES]) {
    struct buf text = {0};
    buf_add_file(&text, path, PLUGIN_BYTES_MAX);
    etag_of(text.data, text.size, edition);
    buf_free(&text);
}

static int plugins_scan(struct voice_pool *pool, const struct voice_pool_options *options, struct error *e) {
    DIR *folder = opendir(options->plugin_dir);
    json_t *config = json_loads(options->config ? options->config : "{}", 0, NULL);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || dot == entry->d_name || strcmp(dot, ".so") != 0)
            continue;
        pool->plugins =
            mem_grow(pool->plugins, &pool->plugin_cap, pool->plugin_count + 1, sizeof *pool->plugins);
        struct plugin *plugin = &pool->plugins[pool->plugin_count++];
        *plugin =
            (struct plugin){.pool = pool, .name = mem_strndup(entry->d_name, (size_t)(dot - entry->d_name))};
        plugin->config = config_of(config, plugin->name);
        plugin->path = mem_alloc(strlen(options->plugin_dir) + strlen(entry->d_name) + 2);
        sprintf(plugin->path, "%s/%s", options->plugin_dir, entry->d_name);
        edition_of(plugin->path, plugin->edition);
    }
    if (folder)
        closedir(folder);
    json_decref(config);
    if (!pool->plugin_count)
        return error_set(e, ERROR_VOICE_UNAVAILABLE, "no voice plugin in \"%s\"", options->plugin_dir);
    pool->plugins = mem_grow(pool->plugins, &pool->plugin_cap, pool->plugin_count + REMOTE_PLUGINS_MAX,
                             sizeof *pool->plugins);
    pool->plugin_cap = pool->plugin_count + REMOTE_PLUGINS_MAX;
    qsort(pool->plugins, pool->plugin_count, sizeof *pool->plugins, by_name);
    return 0;
}

/* Logs them in one line. */
static void plugins_log_absent(const struct voice_pool *pool) {
    struct buf text = {0};
    for (size_t i = 0; i < pool->plugin_count; i++)
        if (pool->plugins[i].absence)
            buf_printf(&text, "%s%s: %s", text.size ? "; " : "", pool->plugins[i].name,
                       pool->plugins[i].absence);
    if (text.size && !pool->quiet)
        log_info("unavailable voices: %.*s", (int)text.size, (const char *)text.data);
    buf_free(&text);
}

void plugins_log_gaps(struct voice_pool *pool, const char *description) {
    if (pool->gaps_logged || pool->unconfined || pool->quiet)
        return;
    json_t *root = json_loads(description, 0, NULL);
    const char *spaces = "", *files = "", *calls = "";
    json_unpack(root, "{s{ssssss}}", "gaps", "spaces", &spaces, "files", &files, "calls", &calls);
    pool->gaps_logged = true;
    if (*calls || *files)
        log_warn("the sandbox of voice plugins is incomplete: %s%s%s", calls, *calls && *files ? ", " : "",
                 files);
    if (*spaces)
        log_info("voice plugins run with %s", spaces);
    json_decref(root);
}

static void plugins_free(struct voice_pool *pool) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        free(pool->plugins[i].name);
        free(pool->plugins[i].path);
        free(pool->plugins[i].config);
        free(pool->plugins[i].absence);
        free(pool->plugins[i].description);
        free(pool->plugins[i].queue);
        free(pool->plugins[i].workers);
    }
    free(pool->plugins);
}

/* Startup: the set of voices decides which one a request gets, so requests wait for the plugins, but not
 * forever. */

enum { START_SECONDS = 30 };

struct voice_wait {
    struct voice_wait *next;
    struct voice_pool *pool;
    void (*changed)(void *ctx);
    void *ctx;
    bool due;
};

static void announce_ready(struct voice_pool *pool) {
    bool speaks = catalog_list(&pool->catalog).count;
    if ((pool->is_ready && pool->speaks >= speaks) || pool->closing)
        return;
    pool->is_ready = true;
    pool->speaks = speaks;
    uv_timer_stop(&pool->start);
    plugins_log_absent(pool);
    if (pool->ready)
        pool->ready(pool->ready_ctx);
}

static void pool_schedule_callbacks(struct voice_pool *pool);

void plugin_settled(struct plugin *plugin) {
    struct voice_pool *pool = plugin->pool;
    bool all = true;
    for (struct voice_wait *w = pool->waits; w; w = w->next)
        w->due = true;
    if (pool->waits)
        pool_schedule_callbacks(pool);
    for (size_t i = 0; i < pool->plugin_count; i++)
        all = all && pool->plugins[i].settled;
    if (all)
        announce_ready(pool);
}

static void on_late(uv_timer_t *timer) {
    struct voice_pool *pool = timer->data;
    for (size_t i = 0; i < pool->plugin_count && !pool->closing; i++) {
        struct plugin *plugin = &pool->plugins[i];
        if (plugin->settled)
            continue;
        log_warn("the voice %s is slow to start; continuing without it", plugin->name);
        plugin->settled = true;
        plugin_settled(plugin);
    }
}

static void pool_start_open(struct voice_pool *pool, double seconds) {
    uv_timer_init(pool->loop, &pool->start);
    pool->start.data = pool;
    pool->open_handles++;
    uv_update_time(pool->loop); /* reading the models took a while */
    uv_timer_start(&pool->start, on_late, (uint64_t)((seconds > 0 ? seconds : START_SECONDS) * 1000) + 1, 0);
}

static void on_timer_closed(uv_handle_t *handle) {
    pool_handle_closed(handle->data);
}

static void pool_start_close(struct voice_pool *pool) {
    uv_close((uv_handle_t *)&pool->start, on_timer_closed);
}

static bool plugin_is_settled(const struct voice_pool *pool, const char *name, size_t length) {
    for (size_t i = 0; i < pool->plugin_count; i++)
        if (strlen(pool->plugins[i].name) == length && !strncmp(pool->plugins[i].name, name, length))
            return pool->plugins[i].settled;
    return true; /* unknown name */
}

/* Voices are sorted by plugin: a later plugin cannot take precedence over earlier ones. */
static bool is_settled_name(const struct voice_pool *pool, const char *name) {
    const struct voice *voice = voice_by_name(catalog_list(&pool->catalog), name);
    const char *colon = strchr(name, ':');
    if (colon)
        return voice || plugin_is_settled(pool, name, (size_t)(colon - name));
    bool all = true;
    for (size_t i = 0; i < pool->plugin_count && (!voice || strcmp(pool->plugins[i].name, voice->plugin) < 0);
         i++)
        all = all && pool->plugins[i].settled;
    return all;
}

bool voice_pool_settled(const struct voice_pool *pool, const char *name, const char *const *preferred) {
    if (pool->is_ready)
        return true;
    if (name)
        return is_settled_name(pool, name);
    for (; preferred && *preferred; preferred++) {
        if (!is_settled_name(pool, *preferred))
            return false;
        if (voice_by_name(catalog_list(&pool->catalog), *preferred))
            return true;
    }
    return false;
}

struct voice_wait *voice_pool_wait(struct voice_pool *pool, void (*changed)(void *ctx), void *ctx) {
    struct voice_wait *wait = mem_alloc(sizeof *wait);
    *wait = (struct voice_wait){.next = pool->waits, .pool = pool, .changed = changed, .ctx = ctx};
    pool->waits = wait;
    return wait;
}

void voice_wait_end(struct voice_wait *wait) {
    if (!wait)
        return;
    struct voice_wait **at = &wait->pool->waits;
    while (*at != wait)
        at = &(*at)->next;
    *at = wait->next;
    free(wait);
}

/* A callback may end any wait. */
static void pool_call_waits(struct voice_pool *pool) {
    struct voice_wait *wait = pool->waits;
    while (wait && !pool->closing) {
        bool due = wait->due;
        wait->due = false;
        if (due)
            wait->changed(wait->ctx);
        wait = due ? pool->waits : wait->next;
    }
}

/* A longer sentence would not fit a frame. */
enum { TEXT_BYTES_MAX = WIRE_PAYLOAD_MAX / 4 };

/* Time per loop iteration for replaying cached sentences. */
enum { RECALL_US = 2000 };

static void on_callback_timer(uv_timer_t *timer) {
    struct voice_pool *pool = timer->data;
    /* Each callback may queue another cached sentence: let the loop run in between. */
    uint64_t begin = uv_hrtime();
    for (struct voice_job *job;
         uv_hrtime() - begin < RECALL_US * 1000 && (job = queue_pop_fair(&pool->cached));)
        job_replay(job);
    /* not 0: all due timers run before other events */
    if (pool->cached.first && !pool->closing)
        uv_timer_start(timer, on_callback_timer, 1, 0);
    queue_fail(&pool->rejected, ERROR_VOICE_FAILED, "does not run, or the sentence is too long");
    pool_call_waits(pool);
}

static void pool_schedule_callbacks(struct voice_pool *pool) {
    if (!pool->closing)
        uv_timer_start(&pool->callback_timer, on_callback_timer, 0, 0);
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
    if (result < 0 || plugins_scan(pool, options, e) < 0) {
        free_pool(pool);
        return NULL;
    }
    if (!pool->unconfined)
        private_memory();
    pool->cache = cache_open(loop, &options->cache);
    pool->cluster = options->cluster;
    pool->work = options->work;
    uv_timer_init(loop, &pool->callback_timer);
    pool->callback_timer.data = pool;
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
    remote_voices_open(pool);
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

struct voice_list voice_pool_retain(struct voice_pool *pool) {
    pool->open_handles++;
    return (struct voice_list){pool->catalog.voices, pool->catalog.count};
}

void voice_pool_release(struct voice_pool *pool) {
    pool_handle_closed(pool);
}

void voice_pool_close(struct voice_pool *pool, void (*closed)(void *ctx), void *ctx) {
    pool->closing = true;
    remote_voices_close(pool);
    pool->closed = closed;
    pool->closed_ctx = ctx;
    uv_close((uv_handle_t *)&pool->callback_timer, on_timer_closed);
    pool_start_close(pool);
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        for (size_t k = 0; k < plugin->seat_count; k++)
            worker_close(&plugin->workers[k]);
        queue_fail(&plugin->urgent, ERROR_CANCELLED, "is shut down");
        queue_fail(&plugin->normal, ERROR_CANCELLED, "is shut down");
        queue_fail(&plugin->background, ERROR_CANCELLED, "is shut down");
    }
    queue_fail(&pool->rejected, ERROR_CANCELLED, "is shut down");
    queue_fail(&pool->cached, ERROR_CANCELLED, "is shut down");
    queue_fail(&pool->querying, ERROR_CANCELLED, "is shut down");
    cache_close(pool->cache);
    pool->cache = NULL;
    pool->cluster = NULL;
    pool->work = NULL;
}

/* Two plugins may share a name: a local one that does not run, and a remote one. */
static struct plugin *plugin_of(struct voice_pool *pool, const struct voice *voice) {
    size_t i = 0;
    while (pool->plugins[i].name != voice->plugin)
        i++;
    return &pool->plugins[i];
}

struct voice_prosody sentence_prosody(const struct sentence_request *request, const struct voice *voice) {
    return (struct voice_prosody){
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
    if (plugin_runs(job->plugin) && job->request.text_bytes <= TEXT_BYTES_MAX && !pool->closing) {
        job_enqueue(job);
    } else {
        queue_push(&pool->rejected, job);
        pool_schedule_callbacks(pool);
    }
}

struct voice_job *voice_pool_speak_request(struct voice_pool *pool, const struct voice *voice,
                                           struct voice_request request,
                                           const struct sentence_request *sentence,
                                           const struct voice_callbacks *callbacks, void *ctx) {
    struct voice_job *job = mem_alloc(sizeof *job);
    job->plugin = plugin_of(pool, voice);
    job->number = pool_number(pool);
    job->voice = voice;
    job->callbacks = *callbacks;
    job->ctx = ctx;
    job->request = request;
    job->priority = sentence->priority;
    job->quota_key = sentence->quota_key;
    job->connection = sentence->connection;
    if (job_find_cached(job)) {
        queue_push_fair(&pool->cached, job);
        pool_schedule_callbacks(pool);
    } else {
        job_query_cluster(job);
    }
    return job;
}

struct voice_job *voice_pool_speak(struct voice_pool *pool, const struct sentence_request *sentence,
                                   const struct voice_callbacks *callbacks, void *ctx) {
    const struct voice_prosody prosody = sentence_prosody(sentence, sentence->voice);
    struct voice_request request;
    voice_request_make(&request, sentence->score, sentence->sentence, &prosody);
    if (sentence->voice->capabilities & FACCIA_VOICE_CONTEXT) {
        const struct score_sentence *s = &sentence->score->sentences[sentence->sentence];
        voice_request_context(&request, sentence->score, sentence->sentence, s->first, s->count);
    }
    return voice_pool_speak_request(pool, sentence->voice, request, sentence, callbacks, ctx);
}

void voice_job_cancel(struct voice_job *job) {
    job->cancelled = true;
    if (job->worker) {
        if (!job->preempted && !job->too_long) /* otherwise it is stopping already */
            worker_cancel(job->worker);
        return;
    }
    queue_remove(job);
    job_free(job);
}
