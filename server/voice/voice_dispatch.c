/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queues of sentences and their completion, replay from the cache, and sharing with other daemons. */
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>

void queue_push(struct job_queue *queue, struct voice_job *job) {
    job->queue = queue;
    if (queue->last)
        queue->last->next = job;
    else
        queue->first = job;
    queue->last = job;
}

static uint64_t job_cost(const struct voice_job *job) {
    return JOB_COST + job->request.text_bytes;
}

void queue_push_fair(struct job_queue *queue, struct voice_job *job) {
    uint64_t start = queue->within[job->quota_key % QUEUE_KEYS];
    for (const struct voice_job *other = queue->first; other; other = other->next)
        if (other->quota_key == job->quota_key && other->connection == job->connection &&
            other->finish > start)
            start = other->finish;
    job->finish = start + job_cost(job);
    job->arrived = queue->now;
    queue_push(queue, job);
}

/* Returns the next job in fair order, or NULL; *end is its finish between quota keys. */
static struct voice_job *queue_next_fair(const struct job_queue *queue, uint64_t *end) {
    struct voice_job *next[QUEUE_KEYS] = {0}, *best = NULL;
    uint64_t arrived[QUEUE_KEYS];
    for (struct voice_job *job = queue->first; job; job = job->next) {
        size_t quota_key = job->quota_key % QUEUE_KEYS;
        if (!next[quota_key])
            arrived[quota_key] = job->arrived; /* of the quota key's oldest job */
        if (!next[quota_key] || job->finish < next[quota_key]->finish)
            next[quota_key] = job;
    }
    for (struct voice_job *job = queue->first; job; job = job->next) {
        size_t quota_key = job->quota_key % QUEUE_KEYS;
        uint64_t from =
            queue->served[quota_key] > arrived[quota_key] ? queue->served[quota_key] : arrived[quota_key];
        if (job != next[quota_key] || (best && from + job_cost(job) >= *end))
            continue;
        best = job;
        *end = from + job_cost(job);
    }
    return best;
}

struct job_queue *job_queue_of(const struct voice_job *job) {
    struct plugin *plugin = job->plugin;
    return job->priority == VOICE_PRIORITY_URGENT       ? &plugin->urgent
           : job->priority == VOICE_PRIORITY_BACKGROUND ? &plugin->background
                                                        : &plugin->normal;
}

void queue_remove(struct voice_job *job) {
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

struct voice_job *queue_pop_fair(struct job_queue *queue) {
    uint64_t end;
    struct voice_job *job = queue_next_fair(queue, &end);
    if (!job)
        return NULL;
    size_t quota_key = job->quota_key % QUEUE_KEYS;
    queue->now = queue->served[quota_key] = end;
    queue->within[quota_key] = job->finish;
    queue_remove(job);
    return job;
}

/* Alternates between urgent and normal jobs, so that new utterances do not starve those being spoken. */
struct voice_job *plugin_next_job(struct plugin *plugin) {
    bool urgent = plugin->urgent.first && (!plugin->normal.first || !plugin->urgent_last);
    plugin->urgent_last = urgent;
    return queue_pop_fair(urgent                 ? &plugin->urgent
                          : plugin->normal.first ? &plugin->normal
                                                 : &plugin->background);
}

static void job_publish(struct voice_job *job);

void job_free(struct voice_job *job) {
    cluster_forget(job->ask);
    job->spoken.size = 0;
    job_publish(job);
    assembly_free(job->assembly);
    voice_request_free(&job->request);
    buf_free(&job->key);
    buf_free(&job->spoken);
    free(job);
}

struct sentence_audio *job_assemble(struct voice_job *job) {
    const struct voice *voice = job->voice;
    return assembly_finish(job->assembly, voice->lang, voice->sample_rate,
                           boundary_table_find(job->plugin->pool->boundaries, voice->id));
}

void job_finish(struct voice_job *job, struct sentence_audio *u, const struct error *e) {
    const struct voice_callbacks callbacks = job->callbacks;
    void *ctx = job->ctx;
    bool cancelled = job->cancelled;
    job_free(job);
    if (cancelled)
        sentence_audio_free(u);
    else if (u)
        callbacks.done(ctx, u);
    else
        callbacks.failed(ctx, e);
}

/* Stops one worker that speaks a background job. */
static void preempt_background(struct plugin *plugin) {
    for (size_t i = 0; i < plugin->seat_count; i++) {
        struct worker *w = &plugin->workers[i];
        if (w->job && w->job->priority == VOICE_PRIORITY_BACKGROUND && w->state == WORKER_SPEAKING) {
            w->job->preempted = true;
            worker_cancel(w);
            return;
        }
    }
}

void job_enqueue(struct voice_job *job) {
    struct plugin *plugin = job->plugin;
    bool stuck = true;
    queue_push_fair(job_queue_of(job), job);
    for (size_t i = 0; i < plugin->seat_count && !job->worker; i++) {
        worker_take_next(&plugin->workers[i]);
        stuck = stuck && worker_is_stuck(&plugin->workers[i]);
    }
    if (job->priority == VOICE_PRIORITY_BACKGROUND)
        return;
    if (!job->worker && stuck)
        plugin_start_spare(plugin);
    if (!job->worker)
        preempt_background(plugin);
}

void queue_fail(struct job_queue *queue, enum error_code code, const char *why) {
    while (queue->first) {
        struct voice_job *job = queue->first;
        struct error e;
        error_set(&e, code, "the voice %s %s", job->plugin->name, why);
        queue_remove(job);
        job_finish(job, NULL, &e);
    }
}

void plugin_fail_waiting(struct plugin *plugin) {
    queue_fail(&plugin->urgent, ERROR_VOICE_FAILED, "does not run");
    queue_fail(&plugin->normal, ERROR_VOICE_FAILED, "does not run");
    queue_fail(&plugin->background, ERROR_VOICE_FAILED, "does not run");
}

bool plugin_runs(const struct plugin *plugin) {
    for (size_t i = 0; i < plugin->worker_count; i++)
        if (!plugin->workers[i].given_up)
            return true;
    return false;
}

/* Largest recording that any consumer keeps; 0 = none. */
static size_t value_max(const struct voice_job *job) {
    const struct voice_pool *pool = job->plugin->pool;
    enum { SHARED = 8 << 20 };
    if (job->frames)
        return WORK_BODY_MOST;
    size_t own = pool->cache ? cache_value_max(pool->cache) : 0;
    return pool->cluster && own < SHARED ? SHARED : own;
}

void job_record(struct voice_job *job, const struct wire_frame *frame) {
    if (job->uncacheable)
        return;
    job_renew_claim(job);
    if (job->spoken.size + frame->size + WIRE_HEADER_BYTES > value_max(job)) {
        job->uncacheable = true;
        buf_free(&job->spoken);
        return;
    }
    size_t place = wire_begin(&job->spoken, frame->type, 0);
    buf_add(&job->spoken, frame->data, frame->size);
    wire_end(&job->spoken, place);
}

void job_store(struct voice_job *job) {
    struct voice_cache *cache = job->plugin->pool->cache;
    if (job->frames && !job->uncacheable)
        job->frames(job->ctx, &job->spoken);
    if (job->uncacheable || !job->spoken.size || job->frames)
        return;
    if (cache)
        cache_put(cache, &job->key, &job->spoken);
    job_publish(job);
}

/* Replays recorded frames as if the worker sent them. Broken data, for example from disk, is spoken anew. */
void job_replay(struct voice_job *job) {
    struct wire_frame frame;
    struct error e;
    size_t used;
    const uint8_t *at = job->spoken.data, *end = at + job->spoken.size;
    int state = 0;
    job->assembly = assembly_new(&job->request);
    while (at < end && (state = wire_next(at, (size_t)(end - at), &frame, &used)) == 1) {
        if (frame.type == WIRE_AUDIO
                ? assembly_audio(job->assembly, &frame, &e)
                : frame.type != WIRE_EVENTS || assembly_events(job->assembly, &frame, &e))
            break;
        at += used;
    }
    if (at == end) {
        job_finish(job, job_assemble(job), NULL);
        return;
    }
    assembly_free(job->assembly);
    job->assembly = NULL;
    job->spoken.size = 0;
    job_begin(job);
}

/* Makes the cache key from the worker's complete request and its edition. Returns true on a hit. */
bool job_find_cached(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    const struct faccia_sentence sentence = voice_request_sentence(&job->request, job->voice->id);
    job->uncacheable = !value_max(job) || job->voice->capabilities & FACCIA_VOICE_FRESH;
    if (job->uncacheable)
        return false;
    wire_put_string(&job->key, job->plugin->edition);
    wire_put_string(&job->key, job->plugin->config);
    wire_put_sentence(&job->key, &sentence);
    if (!pool->cache)
        return false;
    const struct buf *value = cache_get(pool->cache, &job->key);
    metrics_add(pool->metrics, value ? METRIC_CACHE_HITS : METRIC_CACHE_MISSES, 1);
    if (value)
        buf_add(&job->spoken, value->data, value->size);
    return value != NULL;
}

/* Sentences shared between daemons: of several that need the same one, only one speaks it. */

static void on_answer(void *ctx, const struct buf *value) {
    struct voice_job *job = ctx;
    struct voice_pool *pool = job->plugin->pool;
    job->ask = NULL;
    queue_remove(job);
    if (value) {
        if (pool->cache)
            cache_put(pool->cache, &job->key, value);
        buf_add(&job->spoken, value->data, value->size);
        job_replay(job);
    } else {
        job->claimed = uv_now(pool->loop);
        job_begin(job);
    }
}

void job_query_cluster(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    if (job->uncacheable || !cluster_up(pool->cluster)) {
        job_begin(job);
        return;
    }
    queue_push(&pool->querying, job);
    job->ask = cluster_ask(pool->cluster, &job->key, on_answer, job);
}

void job_renew_claim(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    uint64_t now = uv_now(pool->loop);
    if (!job->claimed || now - job->claimed < CLUSTER_CLAIM_MS / 2 || !cluster_up(pool->cluster))
        return;
    cluster_making(pool->cluster, &job->key);
    job->claimed = now;
}

/* Publishes the recording, or the failure, so that others need not wait. */
static void job_publish(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    if (job->claimed && cluster_up(pool->cluster))
        cluster_give(pool->cluster, &job->key, job->spoken.size ? &job->spoken : NULL);
    job->claimed = 0;
}

/* Interface for a worker that serves other daemons. */

bool voice_pool_plugin(const struct voice_pool *pool, size_t index, struct voice_plugin *out) {
    if (index >= pool->plugin_count)
        return false;
    const struct plugin *plugin = &pool->plugins[index];
    *out = (struct voice_plugin){
        .name = plugin->name,
        .edition = plugin->edition,
        .config = plugin->config,
        .description = plugin->description,
        .runs = plugin->listed && plugin_runs(plugin) && !pool->closing,
        .seats = (unsigned)plugin->worker_count,
    };
    return true;
}

static const struct voice *voice_of(const struct plugin *plugin, const char *name) {
    const struct voice_list list = catalog_list(&plugin->pool->catalog);
    for (size_t i = 0; i < list.count; i++)
        if (list.voices[i].plugin == plugin->name &&
            !strcmp(list.voices[i].id + strlen(plugin->name) + 1, name))
            return &list.voices[i];
    return NULL;
}

static char *copy(const char *text) {
    return text ? mem_strdup(text) : NULL;
}

static void copy_spans(struct voice_request *request, const struct faccia_sentence *sentence) {
    request->before = copy(sentence->before);
    request->after = copy(sentence->after);
    request->spans = mem_alloc((sentence->span_count + 1) * sizeof *request->spans);
    request->span_count = request->span_cap = sentence->span_count;
    for (size_t i = 0; i < sentence->span_count; i++) {
        struct faccia_span *span = &request->spans[i];
        *span = sentence->spans[i];
        span->text = copy(span->text);
        span->lang = copy(span->lang);
        span->phones = copy(span->phones);
        span->say_as = copy(span->say_as);
        span->emotion = copy(span->emotion);
        if (span->kind == FACCIA_SPAN_TEXT)
            request->text_bytes += strlen(span->text);
        else if (span->kind == FACCIA_SPAN_BREAK && span->seconds > 0)
            request->break_seconds += span->seconds;
    }
}

struct voice_job *voice_pool_speak_frames(struct voice_pool *pool, size_t index, const struct buf *sentence,
                                          enum voice_priority priority,
                                          void (*frames)(void *ctx, const struct buf *),
                                          const struct voice_callbacks *callbacks, void *ctx,
                                          struct error *e) {
    const struct wire_frame frame = {WIRE_SPEAK, 0, sentence->data, sentence->size};
    struct wire_reader r = wire_read(&frame);
    struct faccia_sentence read;
    struct faccia_span *spans;
    bool well = wire_get_sentence(&r, &read, &spans);
    const struct voice *voice = well ? voice_of(&pool->plugins[index], read.voice) : NULL;
    struct voice_request request = {0};
    if (voice)
        copy_spans(&request, &read);
    free(spans);
    if (!voice) {
        error_set(e, well ? ERROR_UNKNOWN_VOICE : ERROR_VOICE_FAILED,
                  well ? "there is no such voice" : "received an invalid sentence");
        return NULL;
    }
    const struct sentence_request options = {.priority = priority};
    struct voice_job *job = voice_pool_speak_request(pool, voice, request, &options, callbacks, ctx);
    job->frames = frames;
    job->uncacheable = false;
    return job;
}
