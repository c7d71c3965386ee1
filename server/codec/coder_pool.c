/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/coder_pool.h"
#include "server/base/mem.h"
#include <stdatomic.h>
#include <stdlib.h>

/* Target utilisation of the threads: above MOST quality drops; it rises only if utilisation then stays
 * below WELL. */
#define MOST 0.8
#define WELL 0.6
/* From this utilisation on, the threads are behind by an unknown amount, assumed to be SWAMPED_DEMAND. */
#define SWAMPED 0.97
#define SWAMPED_DEMAND 2.0

/* Costs measured with libopus 1.3.1 and resampling from 22050 to 16000 Hz, tests/bench/sound.mjs. */
const struct codec_load_level codec_load_levels[CODEC_LOAD_LEVELS] = {
    {9, false, 19.5}, {5, false, 10.2}, {1, false, 4.7}, {5, true, 4.2}, {0, true, 1.6},
};

void codec_load_open(struct codec_load *codec_load, uv_loop_t *loop, const struct coder_pool *coders,
                     struct metrics *metrics) {
    *codec_load = (struct codec_load){.loop = loop, .coders = coders, .metrics = metrics};
    uv_loop_configure(loop, UV_METRICS_IDLE_TIME);
}

static unsigned less(unsigned level, double busy) {
    double demand = busy > SWAMPED ? SWAMPED_DEMAND : busy, now = codec_load_levels[level].cost;
    if (level + 1 < CODEC_LOAD_LEVELS)
        level++;
    while (level + 1 < CODEC_LOAD_LEVELS && demand * codec_load_levels[level].cost / now > MOST)
        level++;
    return level;
}

unsigned codec_load_choose(unsigned level, double busy, bool calm) {
    if (busy > MOST)
        return less(level, busy);
    if (calm && level && busy * codec_load_levels[level - 1].cost / codec_load_levels[level].cost < WELL)
        return level - 1;
    return level;
}

double codec_load_busy(double loop, double coders, unsigned threads) {
    /* a loop busy with other work profits when coding uses less of its processors */
    bool shares = loop + coders * threads > WELL * threads;
    return loop > MOST && shares && loop > coders ? loop : coders;
}

unsigned codec_load_now(struct codec_load *e) {
    if (!e || !e->coders)
        return CODEC_LOAD_BEST;
    uint64_t now = uv_hrtime(), took = now - e->from;
    if (took < CODEC_LOAD_WINDOW_MS * 1000000ull)
        return e->level;
    uint64_t idle = uv_metrics_idle_time(e->loop), worked = coder_pool_worked(e->coders);
    unsigned threads = coder_pool_threads(e->coders);
    double loop = 1 - (double)(idle - e->idle) / (double)took;
    double busy = codec_load_busy(loop, (double)(worked - e->worked) / (double)took / threads, threads);
    bool calm = now - e->changed >= CODEC_LOAD_CALM_MS * 1000000ull;
    unsigned level = codec_load_choose(e->level, busy, calm);
    if (level != e->level) {
        e->changed = now;
        metrics_add(e->metrics, METRIC_SOUND_LEVEL, (double)level - e->level);
    }
    e->level = level;
    e->from = now;
    e->idle = idle;
    e->worked = worked;
    return level;
}

struct coder_pool {
    uv_async_t async;
    uv_mutex_t mutex; /* protects the lists and `closing` */
    uv_cond_t wanted;
    struct coder_line *first, *last; /* lines with jobs and no thread */
    struct coder_job *done, **done_last;
    bool closing;
    atomic_uint_fast64_t worked;
    unsigned threads;
    uv_thread_t thread[CODER_THREADS_MAX];
};

static void queue_line(struct coder_pool *pool, struct coder_line *line) {
    bool before = !pool->first || line->first->urgent;
    line->next = before ? pool->first : NULL;
    if (!before)
        pool->last->next = line;
    if (!before || !pool->first)
        pool->last = line;
    if (before)
        pool->first = line;
}

static void put_done(struct coder_pool *pool, struct coder_job *job) {
    job->next = NULL;
    *pool->done_last = job;
    pool->done_last = &job->next;
}

/* Runs one job of the first line without the mutex, which is held on entry and exit. A line runs one job
 * at a time, then others get their turn. */
static void do_next(struct coder_pool *pool) {
    struct coder_line *line = pool->first;
    struct coder_job *job = line->first;
    pool->first = line->next;
    line->first = job->next;
    bool work = !job->cancelled;
    uv_mutex_unlock(&pool->mutex);
    if (work) {
        uint64_t from = uv_hrtime();
        job->work(job);
        atomic_fetch_add_explicit(&pool->worked, uv_hrtime() - from, memory_order_relaxed);
    }
    uv_mutex_lock(&pool->mutex);
    bool first = !pool->done;
    put_done(pool, job);
    line->queued = line->first;
    if (line->queued)
        queue_line(pool, line);
    if (first)
        uv_async_send(&pool->async);
}

static void run(void *ctx) {
    struct coder_pool *pool = ctx;
    uv_mutex_lock(&pool->mutex);
    while (!pool->closing) {
        if (pool->first)
            do_next(pool);
        else
            uv_cond_wait(&pool->wanted, &pool->mutex);
    }
    uv_mutex_unlock(&pool->mutex);
}

static void call_done(struct coder_pool *pool) {
    uv_mutex_lock(&pool->mutex);
    struct coder_job *job = pool->done, *next;
    pool->done = NULL;
    pool->done_last = &pool->done;
    uv_mutex_unlock(&pool->mutex);
    for (; job; job = next) {
        next = job->next;
        job->done(job);
    }
}

static void on_async(uv_async_t *async) {
    call_done(async->data);
}

static void on_closed(uv_handle_t *async) {
    free(async->data);
}

struct coder_pool *coder_pool_open(uv_loop_t *loop, unsigned threads) {
    struct coder_pool *pool = mem_alloc(sizeof *pool);
    if (!threads)
        threads = (uv_available_parallelism() + 1) / 2;
    if (threads > CODER_THREADS_MAX)
        threads = CODER_THREADS_MAX;
    pool->done_last = &pool->done;
    uv_async_init(loop, &pool->async, on_async);
    pool->async.data = pool;
    uv_mutex_init(&pool->mutex);
    uv_cond_init(&pool->wanted);
    while (pool->threads < threads && !uv_thread_create(&pool->thread[pool->threads], run, pool))
        pool->threads++;
    if (pool->threads)
        return pool;
    coder_pool_close(pool);
    return NULL;
}

void coder_pool_close(struct coder_pool *pool) {
    if (!pool)
        return;
    uv_mutex_lock(&pool->mutex);
    pool->closing = true;
    uv_cond_broadcast(&pool->wanted);
    uv_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->threads; i++)
        uv_thread_join(&pool->thread[i]);
    for (struct coder_line *line = pool->first; line; line = line->next) {
        for (struct coder_job *job; (job = line->first);) {
            line->first = job->next;
            job->cancelled = true;
            put_done(pool, job);
        }
        line->queued = false;
    }
    pool->first = NULL;
    call_done(pool);
    uv_cond_destroy(&pool->wanted);
    uv_mutex_destroy(&pool->mutex);
    uv_close((uv_handle_t *)&pool->async, on_closed);
}

void coder_pool_submit(struct coder_pool *pool, struct coder_line *line, struct coder_job *job) {
    job->next = NULL;
    uv_mutex_lock(&pool->mutex);
    if (line->first)
        line->last->next = job;
    else
        line->first = job;
    line->last = job;
    if (!line->queued) {
        line->queued = true;
        queue_line(pool, line);
        uv_cond_signal(&pool->wanted);
    }
    uv_mutex_unlock(&pool->mutex);
}

void coder_pool_cancel(struct coder_pool *pool, struct coder_line *line,
                       bool (*which)(struct coder_job *job)) {
    uv_mutex_lock(&pool->mutex);
    for (struct coder_job *job = line->first; job; job = job->next)
        job->cancelled = job->cancelled || which(job);
    uv_mutex_unlock(&pool->mutex);
}

unsigned coder_pool_threads(const struct coder_pool *pool) {
    return pool->threads;
}

uint64_t coder_pool_worked(const struct coder_pool *pool) {
    return atomic_load_explicit(&pool->worked, memory_order_relaxed);
}
