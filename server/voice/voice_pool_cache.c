/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that were spoken before: what a worker says is kept, and said again. */
#include "server/voice/voice_pool_internal.h"

/* The most that anybody keeps of one sentence; 0: nobody keeps any. */
static size_t value_max(const struct voice_job *job) {
    const struct voice_pool *pool = job->plugin->pool;
    enum { SHARED = 8 << 20 };
    if (job->frames)
        return WORK_BODY_MOST;
    size_t own = pool->cache ? cache_value_max(pool->cache) : 0;
    return pool->cluster && own < SHARED ? SHARED : own;
}

void pool_job_said(struct voice_job *job, const struct wire_frame *frame) {
    if (job->uncacheable)
        return;
    job_making(job);
    if (job->spoken.size + frame->size + WIRE_HEADER_BYTES > value_max(job)) {
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
    if (job->frames && !job->uncacheable)
        job->frames(job->ctx, &job->spoken);
    if (job->uncacheable || !job->spoken.size || job->frames)
        return;
    if (cache)
        cache_put(cache, &job->key, &job->spoken);
    job_share(job);
}

/* Says again what the worker once said; a value that cannot be used (it lay on a disk) is spoken anew. */
void job_recall(struct voice_job *job) {
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
        pool_job_end(job, pool_job_finish(job), NULL);
        return;
    }
    assembly_free(job->assembly);
    job->assembly = NULL;
    job->spoken.size = 0;
    job_begin(job);
}

/* Makes the key: all that the worker is told, and which worker it is. True when the cache has the sentence.
 */
bool job_look_up(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    const struct faccia_sentence sentence = plan_sentence(&job->plan, job->voice->id);
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
