/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that another daemon has spoken, or is speaking: of those that ask for one at the same time, one
 * makes it. */
#include "server/voice/voice_pool_internal.h"

static void on_answer(void *ctx, const struct buf *value) {
    struct voice_job *job = ctx;
    struct voice_pool *pool = job->plugin->pool;
    job->ask = NULL;
    job_take_out(job);
    if (value) {
        if (pool->cache)
            cache_put(pool->cache, &job->key, value);
        buf_add(&job->spoken, value->data, value->size);
        job_recall(job);
    } else {
        job->claimed = uv_now(pool->loop);
        job_begin(job);
    }
}

void job_ask(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    if (job->uncacheable || !cluster_up(pool->cluster)) {
        job_begin(job);
        return;
    }
    job_push(&pool->asked, job);
    job->ask = cluster_ask(pool->cluster, &job->key, on_answer, job);
}

void job_making(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    uint64_t now = uv_now(pool->loop);
    if (!job->claimed || now - job->claimed < CLUSTER_CLAIM_MS / 2 || !cluster_up(pool->cluster))
        return;
    cluster_making(pool->cluster, &job->key);
    job->claimed = now;
}

void job_share(struct voice_job *job) {
    struct voice_pool *pool = job->plugin->pool;
    if (job->claimed && cluster_up(pool->cluster))
        cluster_give(pool->cluster, &job->key, job->spoken.size ? &job->spoken : NULL);
    job->claimed = 0;
}
