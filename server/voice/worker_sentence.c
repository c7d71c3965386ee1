/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a worker is given to speak, and what it says of it. */
#include "server/base/log.h"
#include "server/voice/far_process.h"
#include "server/voice/voice_pool_internal.h"
#include "server/voice/worker_process.h"
#include <string.h>

enum {
    SLOW_PATIENCE = 4, /* times the deadline, for voices that say that they are slow */
    STOP_MS = 300,     /* to stop speaking when told to */
    WAY_MS = 2000,     /* the same, for somebody who would wait longer for another process */
};

/* Where it speaks, what is wrong was said already: "the voice NAME took too long". */
static void far_failed(const struct worker *w, uint32_t code, const char *message, struct error *e) {
    static const char named[] = "the voice ";
    bool whole = !strncmp(message, named, sizeof named - 1);
    error_set(e, (enum error_code)code, "%s%s%s%s", whole ? "" : named, whole ? "" : w->plugin->name,
              whole ? "" : " ", message);
}

static int error_too_long(struct error *e) {
    return error_set(e, ERROR_TEXT_TOO_LONG, "a sentence makes more sound than one may have: it is left out");
}

/* All has been said about the sentence. */
static void done(struct worker *w, struct wire_reader *r) {
    struct voice_job *job = w->job;
    uint32_t failed = wire_get_u32(r);
    const char *message = wire_get_string(r);
    struct error e;
    if (r->bad) {
        worker_lose(w, ERROR_VOICE_FAILED, "sent garbage", false);
        return;
    }
    struct sentence_audio *u = NULL;
    w->failed_starts = 0;
    if (job->cancelled)
        failed = 0;
    else if (job->gave_way)
        failed = (uint32_t)-error_plain(&e, ERROR_CANCELLED);
    else if (job->too_long)
        failed = (uint32_t)-error_too_long(&e);
    else if (failed && w->plugin->queue)
        far_failed(w, failed, message ? message : "", &e);
    else if (failed)
        error_set(&e, ERROR_VOICE_FAILED, "the voice %s failed: %s", w->plugin->name,
                  message && *message ? message : "it does not say why");
    else {
        u = pool_job_finish(job);
        pool_job_spoken(job);
    }
    worker_set_state(w, WORKER_IDLE, 0);
    worker_end_job(w, u, failed ? &e : NULL);
    worker_wake(w);
}

/* It speaks: until it has been silent for too long, or spoken for too long. */
static void be_patient(struct worker *w) {
    uint64_t now = uv_now(w->plugin->pool->loop), left = w->end > now ? w->end - now : 1;
    worker_set_state(w, WORKER_SPEAKING, left < w->patience ? left : w->patience);
}

/* What it says of a sentence that another one speaks counts for nothing, but it can be used again. */
static void came_back(struct worker *w, const struct wire_frame *frame) {
    if (frame->type != WIRE_DONE)
        return;
    log_info("the voice %s: the worker that fell silent has come back", w->plugin->name);
    worker_set_state(w, WORKER_IDLE, 0);
    worker_wake(w);
}

/* Its sound is not wanted any more. */
static bool is_dropped(const struct voice_job *job) {
    return job->cancelled || job->too_long;
}

void worker_said(void *ctx, const struct wire_frame *frame) {
    struct worker *w = ctx;
    struct wire_reader r = wire_read(frame);
    struct error e;
    int result = 0;
    if (w->state == WORKER_STARTING) {
        worker_greeted(w, frame);
        return;
    }
    spare_heard(w);
    if (frame->type == WIRE_ALIVE && (w->job || w->state == WORKER_LOST)) {
        if (w->job)
            job_making(w->job);
        return;
    }
    if (frame->type == WIRE_WAITING && w->plugin->queue && w->job) {
        job_making(w->job);
        w->end =
            uv_now(w->plugin->pool->loop) + (uint64_t)((double)w->patience * w->plugin->pool->deadline_most);
        if (w->state == WORKER_SPEAKING)
            be_patient(w);
        return;
    }
    if (w->state == WORKER_LOST && frame->job == w->dropped) {
        came_back(w, frame);
        return;
    }
    bool expected = w->job && frame->job == w->job->number;
    if (expected && frame->type == WIRE_DONE)
        done(w, &r);
    else if (expected && frame->type == WIRE_AUDIO)
        result = is_dropped(w->job) ? 0 : assembly_audio(w->job->assembly, frame, &e);
    else if (expected && frame->type == WIRE_EVENTS)
        result = is_dropped(w->job) ? 0 : assembly_events(w->job->assembly, frame, &e);
    else
        result = error_set(&e, ERROR_VOICE_FAILED, "sent garbage");
    if (!result && w->job && (frame->type == WIRE_AUDIO || frame->type == WIRE_EVENTS)) {
        pool_job_said(w->job, frame);
        if (w->state == WORKER_SPEAKING)
            be_patient(w);
    }
    if (result < 0 && e.code == ERROR_TEXT_TOO_LONG && w->state == WORKER_SPEAKING) {
        w->job->too_long = true; /* the text's doing: a voice that stops when told to is not at fault */
        worker_cancel(w);
    } else if (result < 0) {
        worker_lose(w, e.code, e.message, false);
    }
}

void worker_wake(struct worker *w) {
    struct voice_pool *pool = w->plugin->pool;
    if (w->state != WORKER_IDLE || pool->closing)
        return;
    spare_rescue(w->plugin);
    struct voice_job *job = pool_next_job(w->plugin);
    if (!job) {
        if (w->spare && !uv_is_active((uv_handle_t *)&w->timer))
            worker_set_state(w, WORKER_IDLE, WORKER_RETIRE_MS);
        return;
    }
    double seconds = pool->deadline_base + pool->deadline_per_byte * (double)job->plan.text_bytes;
    if (job->voice->capabilities & FACCIA_VOICE_SLOW)
        seconds *= SLOW_PATIENCE;
    w->patience = (uint64_t)(seconds * 1000) + 1;
    w->end = uv_now(pool->loop) + (uint64_t)((double)w->patience * pool->deadline_most);
    const struct faccia_sentence sentence =
        plan_sentence(&job->plan, job->voice->id + strlen(w->plugin->name) + 1);
    struct buf b = {0};
    size_t place = wire_begin(&b, WIRE_SPEAK, job->number);
    wire_put_u32(&b, worker_processor_seconds(pool, w->patience));
    wire_put_sentence(&b, &sentence);
    wire_end(&b, place);
    job->worker = w;
    job->gave_way = false;
    job->assembly = assembly_new(&job->plan);
    w->job = job;
    be_patient(w);
    spare_watch(w);
    if (w->plugin->queue)
        far_process_turn(w->process, job->turn, job->payer);
    process_send(w->process, &b);
    buf_free(&b);
}

static void tell_to_stop(struct worker *w) {
    struct buf b = {0};
    size_t place = wire_begin(&b, WIRE_CANCEL, w->job->number);
    wire_end(&b, place);
    process_send(w->process, &b);
    buf_free(&b);
}

void worker_cancel(struct worker *w) {
    worker_set_state(w, WORKER_STOPPING, w->job->gave_way ? WAY_MS : STOP_MS);
    tell_to_stop(w);
}

/* Its own deadline stays: by then it is back, or another process takes its place. */
struct voice_job *worker_give_up_job(struct worker *w) {
    struct voice_job *job = w->job;
    struct voice_pool *pool = w->plugin->pool;
    tell_to_stop(w);
    w->dropped = job->number;
    w->state = WORKER_LOST;
    w->job = NULL;
    assembly_free(job->assembly);
    job->assembly = NULL;
    job->spoken.size = 0;
    job->worker = NULL;
    job->number = pool_number(pool); /* what the first one still says of it has another */
    return job;
}
