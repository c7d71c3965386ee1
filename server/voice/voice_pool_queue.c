/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that wait for a worker, and how each of them ends. */
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>

void job_push(struct job_queue *queue, struct voice_job *job) {
    job->queue = queue;
    if (queue->last)
        queue->last->next = job;
    else
        queue->first = job;
    queue->last = job;
}

static uint64_t job_cost(const struct voice_job *job) {
    return JOB_COST + job->plan.text_bytes;
}

void job_push_in_turn(struct job_queue *queue, struct voice_job *job) {
    uint64_t start = queue->within[job->payer % QUEUE_PAYERS];
    for (const struct voice_job *other = queue->first; other; other = other->next)
        if (other->payer == job->payer && other->asker == job->asker && other->ends > start)
            start = other->ends;
    job->ends = start + job_cost(job);
    job->came = queue->now;
    job_push(queue, job);
}

/* The job whose turn it is, or NULL; *end: its end between payers. */
static struct voice_job *job_in_turn(const struct job_queue *queue, uint64_t *end) {
    struct voice_job *next[QUEUE_PAYERS] = {0}, *best = NULL;
    uint64_t came[QUEUE_PAYERS];
    for (struct voice_job *job = queue->first; job; job = job->next) {
        size_t payer = job->payer % QUEUE_PAYERS;
        if (!next[payer])
            came[payer] = job->came; /* of the oldest: since then the payer waits */
        if (!next[payer] || job->ends < next[payer]->ends)
            next[payer] = job;
    }
    for (struct voice_job *job = queue->first; job; job = job->next) {
        size_t payer = job->payer % QUEUE_PAYERS;
        uint64_t from = queue->served[payer] > came[payer] ? queue->served[payer] : came[payer];
        if (job != next[payer] || (best && from + job_cost(job) >= *end))
            continue;
        best = job;
        *end = from + job_cost(job);
    }
    return best;
}

struct job_queue *job_queue_of(const struct voice_job *job) {
    struct plugin *plugin = job->plugin;
    return job->turn == VOICE_TURN_URGENT  ? &plugin->urgent
           : job->turn == VOICE_TURN_AHEAD ? &plugin->ahead
                                           : &plugin->waiting;
}

void job_take_out(struct voice_job *job) {
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

struct voice_job *job_take_next(struct job_queue *queue) {
    uint64_t end;
    struct voice_job *job = job_in_turn(queue, &end);
    if (!job)
        return NULL;
    size_t payer = job->payer % QUEUE_PAYERS;
    queue->now = queue->served[payer] = end;
    queue->within[payer] = job->ends;
    job_take_out(job);
    return job;
}

/* Those that somebody waits for and those that are made ahead by turns: however many begin to speak, who
 * speaks already goes on. */
struct voice_job *pool_next_job(struct plugin *plugin) {
    bool urgent = plugin->urgent.first && (!plugin->waiting.first || !plugin->urgent_last);
    plugin->urgent_last = urgent;
    return job_take_next(urgent                  ? &plugin->urgent
                         : plugin->waiting.first ? &plugin->waiting
                                                 : &plugin->ahead);
}

void job_free(struct voice_job *job) {
    cluster_forget(job->ask);
    job->spoken.size = 0;
    job_share(job);
    assembly_free(job->assembly);
    plan_free(&job->plan);
    buf_free(&job->key);
    buf_free(&job->spoken);
    free(job);
}

struct sentence_audio *pool_job_finish(struct voice_job *job) {
    const struct voice *voice = job->voice;
    return assembly_finish(job->assembly, voice->lang, voice->sample_rate,
                           boundary_table_find(job->plugin->pool->boundaries, voice->id));
}

void pool_job_end(struct voice_job *job, struct sentence_audio *u, const struct error *e) {
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

/* Somebody waits while a worker speaks for nobody: it stops. One is enough. */
static void make_way(struct plugin *plugin) {
    for (size_t i = 0; i < plugin->seat_count; i++) {
        struct worker *w = &plugin->workers[i];
        if (w->job && w->job->turn == VOICE_TURN_AHEAD && w->state == WORKER_SPEAKING) {
            w->job->gave_way = true;
            worker_cancel(w);
            return;
        }
    }
}

void job_wait(struct voice_job *job) {
    struct plugin *plugin = job->plugin;
    bool stuck = true;
    job_push_in_turn(job_queue_of(job), job);
    for (size_t i = 0; i < plugin->seat_count && !job->worker; i++) {
        worker_wake(&plugin->workers[i]);
        stuck = stuck && spare_is_stuck(&plugin->workers[i]);
    }
    if (job->turn == VOICE_TURN_AHEAD)
        return;
    if (!job->worker && stuck)
        spare_call(plugin);
    if (!job->worker)
        make_way(plugin);
}

void queue_fail(struct job_queue *queue, enum error_code code, const char *why) {
    while (queue->first) {
        struct voice_job *job = queue->first;
        struct error e;
        error_set(&e, code, "the voice %s %s", job->plugin->name, why);
        job_take_out(job);
        pool_job_end(job, NULL, &e);
    }
}

void pool_fail_waiting(struct plugin *plugin) {
    queue_fail(&plugin->urgent, ERROR_VOICE_FAILED, "does not run");
    queue_fail(&plugin->waiting, ERROR_VOICE_FAILED, "does not run");
    queue_fail(&plugin->ahead, ERROR_VOICE_FAILED, "does not run");
}

bool plugin_runs(const struct plugin *plugin) {
    for (size_t i = 0; i < plugin->worker_count; i++)
        if (!plugin->workers[i].given_up)
            return true;
    return false;
}
