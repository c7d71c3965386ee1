/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Workers: starting and restarting processes, sending them sentences, and spare workers for when one is
 * stuck (its process was stopped, or gets no processor time) or busy with a long sentence. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>

/* A working process sends ALIVE every WIRE_ALIVE_MS. Checks are counted instead of milliseconds: if the
 * daemon itself was blocked, it makes one check and then reads everything that arrived meanwhile. */
enum { CHECK_MS = WIRE_ALIVE_MS, STALLED_CHECKS = 3, BUSY_CHECKS = 4 };

static bool is_stalled(const struct worker *w) {
    return w->state == WORKER_SPEAKING && w->silent >= STALLED_CHECKS;
}

bool worker_is_stuck(const struct worker *w) {
    return w->state == WORKER_STUCK || w->state == WORKER_OFF || is_stalled(w);
}

static void on_check(uv_timer_t *timer) {
    struct worker *w = timer->data;
    struct plugin *plugin = w->plugin;
    if (w->state != WORKER_SPEAKING || plugin->pool->closing) {
        uv_timer_stop(timer);
        return;
    }
    bool others = plugin->urgent.first || plugin->normal.first;
    bool slow =
        w->job->voice->capabilities & FACCIA_VOICE_SLOW; /* a spare would compete for the processors */
    w->checks++;
    w->silent++;
    if (is_stalled(w) || (others && !slow && w->checks >= BUSY_CHECKS))
        plugin_start_spare(plugin);
}

static void watch_worker(struct worker *w) {
    w->checks = w->silent = 0;
    uv_timer_start(&w->pulse, on_check, CHECK_MS, CHECK_MS);
}

static void note_activity(struct worker *w) {
    w->silent = 0;
}

static void start(struct worker *w);

/* Starts a spare unless a worker is idle or starting. Stuck workers do not count as active. */
void plugin_start_spare(struct plugin *plugin) {
    struct worker *spare = NULL;
    size_t active = 0;
    for (size_t i = 0; i < plugin->seat_count; i++) {
        struct worker *w = &plugin->workers[i];
        if (w->state == WORKER_IDLE) {
            worker_take_next(w);
            return;
        }
        if (w->state == WORKER_STARTING)
            return;
        active += !worker_is_stuck(w);
        if (w->state == WORKER_OFF && w->not_before <= uv_now(plugin->pool->loop))
            spare = w;
    }
    if (!spare || active >= plugin->worker_count + plugin->spare_count)
        return;
    log_info("the voice %s is stuck or busy with a long sentence; starting a spare worker", plugin->name);
    start(spare);
}

static struct voice_job *worker_release_job(struct worker *w);

/* Requeues the sentences of stuck workers, once each, because the sentence itself may be the cause. They
 * go to the end, because they may take long. */
static void requeue_stuck(struct plugin *plugin) {
    for (size_t i = 0; i < plugin->seat_count; i++) {
        struct worker *w = &plugin->workers[i];
        if (!is_stalled(w) || w->job->requeued)
            continue;
        struct voice_job *job = worker_release_job(w);
        job->requeued = true;
        queue_push(job_queue_of(job), job);
    }
}

static bool regulars_idle(const struct plugin *plugin) {
    for (size_t i = 0; i < plugin->worker_count; i++)
        if (plugin->workers[i].state != WORKER_IDLE)
            return false;
    return true;
}

enum {
    SLOW_FACTOR = 4,   /* multiplies the deadline of FACCIA_VOICE_SLOW */
    STOP_MS = 300,     /* to stop speaking when told to */
    PREEMPT_MS = 2000, /* the same for preemption, where starting a new process would take longer */
};

/* A remote error may already begin with "the voice NAME". */
static void remote_failed(const struct worker *w, uint32_t code, const char *message, struct error *e) {
    static const char named[] = "the voice ";
    bool whole = !strncmp(message, named, sizeof named - 1);
    error_set(e, (enum error_code)code, "%s%s%s%s", whole ? "" : named, whole ? "" : w->plugin->name,
              whole ? "" : " ", message);
}

static int error_too_long(struct error *e) {
    return error_set(e, ERROR_TEXT_TOO_LONG, "a sentence exceeds the maximum duration and is skipped");
}

static void worker_set_state(struct worker *w, enum worker_state state, uint64_t ms);

static void end_job(struct worker *w, struct sentence_audio *u, const struct error *e);

static void worker_fail(struct worker *w, enum error_code code, const char *why, bool hopeless);

/* Handles DONE. */
static void done(struct worker *w, struct wire_reader *r) {
    struct voice_job *job = w->job;
    uint32_t failed = wire_get_u32(r);
    const char *message = wire_get_string(r);
    struct error e;
    if (r->bad) {
        worker_fail(w, ERROR_VOICE_FAILED, "sent garbage", false);
        return;
    }
    struct sentence_audio *u = NULL;
    w->failed_starts = 0;
    if (job->cancelled)
        failed = 0;
    else if (job->preempted)
        failed = (uint32_t)-error_plain(&e, ERROR_CANCELLED);
    else if (job->too_long)
        failed = (uint32_t)-error_too_long(&e);
    else if (failed && w->plugin->queue)
        remote_failed(w, failed, message ? message : "", &e);
    else if (failed)
        error_set(&e, ERROR_VOICE_FAILED, "the voice %s failed: %s", w->plugin->name,
                  message && *message ? message : "no reason given");
    else {
        u = job_assemble(job);
        job_store(job);
    }
    worker_set_state(w, WORKER_IDLE, 0);
    end_job(w, u, failed ? &e : NULL);
    worker_take_next(w);
}

/* Restarts the timer: fails on silence, or at the sentence's final deadline. */
static void extend_deadline(struct worker *w) {
    uint64_t now = uv_now(w->plugin->pool->loop), left = w->end > now ? w->end - now : 1;
    worker_set_state(w, WORKER_SPEAKING, left < w->silence_max ? left : w->silence_max);
}

/* Ignores output of a requeued sentence; on its DONE the worker is usable again. */
static void recover(struct worker *w, const struct wire_frame *frame) {
    if (frame->type != WIRE_DONE)
        return;
    log_info("the voice %s: the stuck worker has recovered", w->plugin->name);
    worker_set_state(w, WORKER_IDLE, 0);
    worker_take_next(w);
}

static bool is_dropped(const struct voice_job *job) {
    return job->cancelled || job->too_long;
}

static void worker_on_hello(struct worker *w, const struct wire_frame *frame);

static void worker_on_frame(void *ctx, const struct wire_frame *frame) {
    struct worker *w = ctx;
    struct wire_reader r = wire_read(frame);
    struct error e;
    int result = 0;
    if (w->state == WORKER_STARTING) {
        worker_on_hello(w, frame);
        return;
    }
    note_activity(w);
    if (frame->type == WIRE_ALIVE && (w->job || w->state == WORKER_STUCK)) {
        if (w->job)
            job_renew_claim(w->job);
        return;
    }
    if (frame->type == WIRE_WAITING && w->plugin->queue && w->job) {
        job_renew_claim(w->job);
        w->end = uv_now(w->plugin->pool->loop) +
                 (uint64_t)((double)w->silence_max * w->plugin->pool->deadline_most);
        if (w->state == WORKER_SPEAKING)
            extend_deadline(w);
        return;
    }
    if (w->state == WORKER_STUCK && frame->job == w->dropped) {
        recover(w, frame);
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
        job_record(w->job, frame);
        if (w->state == WORKER_SPEAKING)
            extend_deadline(w);
    }
    if (result < 0 && e.code == ERROR_TEXT_TOO_LONG && w->state == WORKER_SPEAKING) {
        w->job->too_long = true; /* the text's fault: a voice that stops when told to is not restarted */
        worker_cancel(w);
    } else if (result < 0) {
        worker_fail(w, e.code, e.message, false);
    }
}

static uint32_t worker_processor_seconds(const struct voice_pool *pool, uint64_t ms);

void worker_take_next(struct worker *w) {
    struct voice_pool *pool = w->plugin->pool;
    if (w->state != WORKER_IDLE || pool->closing)
        return;
    requeue_stuck(w->plugin);
    struct voice_job *job = plugin_next_job(w->plugin);
    if (!job) {
        if (w->spare && !uv_is_active((uv_handle_t *)&w->timer))
            worker_set_state(w, WORKER_IDLE, WORKER_RETIRE_MS);
        return;
    }
    double seconds = pool->deadline_base + pool->deadline_per_byte * (double)job->request.text_bytes;
    if (job->voice->capabilities & FACCIA_VOICE_SLOW)
        seconds *= SLOW_FACTOR;
    w->silence_max = (uint64_t)(seconds * 1000) + 1;
    w->end = uv_now(pool->loop) + (uint64_t)((double)w->silence_max * pool->deadline_most);
    const struct faccia_sentence sentence =
        voice_request_sentence(&job->request, job->voice->id + strlen(w->plugin->name) + 1);
    struct buf b = {0};
    size_t place = wire_begin(&b, WIRE_SPEAK, job->number);
    wire_put_u32(&b, worker_processor_seconds(pool, w->silence_max));
    wire_put_sentence(&b, &sentence);
    wire_end(&b, place);
    job->worker = w;
    job->preempted = false;
    job->assembly = assembly_new(&job->request);
    w->job = job;
    extend_deadline(w);
    watch_worker(w);
    if (w->plugin->queue)
        remote_process_schedule(w->process, job->priority, job->quota_key);
    process_send(w->process, &b);
    buf_free(&b);
}

static void send_cancel(struct worker *w) {
    struct buf b = {0};
    size_t place = wire_begin(&b, WIRE_CANCEL, w->job->number);
    wire_end(&b, place);
    process_send(w->process, &b);
    buf_free(&b);
}

void worker_cancel(struct worker *w) {
    worker_set_state(w, WORKER_STOPPING, w->job->preempted ? PREEMPT_MS : STOP_MS);
    send_cancel(w);
}

/* Gives up the sentence for another worker. The deadline stays: by then it has recovered or is replaced. */
static struct voice_job *worker_release_job(struct worker *w) {
    struct voice_job *job = w->job;
    struct voice_pool *pool = w->plugin->pool;
    send_cancel(w);
    w->dropped = job->number;
    w->state = WORKER_STUCK;
    w->job = NULL;
    assembly_free(job->assembly);
    job->assembly = NULL;
    job->spoken.size = 0;
    job->worker = NULL;
    job->number = pool_number(pool); /* so that late frames of the stuck worker are not taken for it */
    return job;
}

enum {
    START_MS = 30000, /* for HELLO: a neural voice loads its weights */
    BACKOFF_MS = 100, /* before the second start in a row, then doubled */
    STARTS = 5,       /* in a row before the plugin is given up for retry_after */
    NO_ROOM_MS = 100, /* before the next start when system resources are short */
    NO_ROOM_LOG_MS = 1000,
    PROCESSOR_SECONDS_MAX = 1 << 30,
};

static void start(struct worker *w);

static void on_time(uv_timer_t *timer);

/* Sets the state and its deadline; ms 0 = none. */
static void worker_set_state(struct worker *w, enum worker_state state, uint64_t ms) {
    w->state = state;
    if (ms)
        uv_timer_start(&w->timer, on_time, ms, 0);
    else
        uv_timer_stop(&w->timer);
}

static void end_job(struct worker *w, struct sentence_audio *u, const struct error *e) {
    struct voice_job *job = w->job;
    w->job = NULL;
    if (job)
        job_finish(job, u, e);
}

static void give_up(struct worker *w, const char *why) {
    struct plugin *plugin = w->plugin;
    if (w->absent && !plugin->settled && !plugin->absence)
        plugin->absence = mem_strdup(why);
    if (!w->given_up && !w->absent)
        log_error("the voice %s does not start: %s; retrying every %.0f s", plugin->name, why,
                  plugin->pool->retry_after);
    w->given_up = true;
    worker_set_state(w, WORKER_BACKOFF, (uint64_t)(plugin->pool->retry_after * 1000) + 1);
    if (plugin_runs(plugin))
        return;
    plugin->settled = true;
    plugin_fail_waiting(plugin);
    plugin_settled(plugin);
}

static void turn_off(struct worker *w, uint64_t delay_ms) {
    w->not_before = uv_now(w->plugin->pool->loop) + delay_ms;
    worker_set_state(w, WORKER_OFF, 0);
}

/* Schedules the next start after a failed one, with exponential backoff. */
static void back_off(struct worker *w, const char *why, bool hopeless) {
    w->failed_starts++;
    if (w->spare)
        turn_off(w, (uint64_t)BACKOFF_MS << (w->failed_starts < STARTS ? w->failed_starts : STARTS));
    else if (hopeless || w->failed_starts >= STARTS || w->given_up)
        give_up(w, why);
    else
        worker_set_state(w, WORKER_BACKOFF, (uint64_t)BACKOFF_MS << (w->failed_starts - 1));
}

/* Replaces a lost process and fails its sentence; why follows "the voice NAME". Restarts at once if the
 * process had worked before. */
static void worker_fail(struct worker *w, enum error_code code, const char *why, bool hopeless) {
    struct plugin *plugin = w->plugin;
    enum worker_state state = w->state;
    struct error e;
    if (plugin->pool->closing)
        return;
    if (w->process)
        process_stop(w->process, hopeless); /* it said why it ends, so let it */
    w->process = NULL;
    error_set(&e, w->job && w->job->preempted ? ERROR_CANCELLED : code, "the voice %s %s", plugin->name, why);
    if (state == WORKER_IDLE || state == WORKER_SPEAKING || state == WORKER_STUCK)
        log_warn("the voice %s %s; restarting it", plugin->name, why);
    w->state = WORKER_BACKOFF;
    if (state == WORKER_IDLE || state == WORKER_STARTING || state == WORKER_BACKOFF)
        back_off(w, why, hopeless);
    else if (w->spare && regulars_idle(plugin))
        turn_off(w, 0);
    else
        start(w);
    end_job(w, NULL, &e);
}

static void worker_retire(struct worker *w);

static void on_time(uv_timer_t *timer) {
    struct worker *w = timer->data;
    switch (w->state) {
    case WORKER_STARTING:
        worker_fail(w, ERROR_VOICE_FAILED, "does not answer", false);
        break;
    case WORKER_SPEAKING:
        worker_fail(w, ERROR_VOICE_TIMEOUT, "took too long", false);
        break;
    case WORKER_STOPPING:
        worker_fail(w, ERROR_VOICE_TIMEOUT, "did not stop", false);
        break;
    case WORKER_STUCK:
        worker_fail(w, ERROR_VOICE_TIMEOUT, "did not recover", false);
        break;
    case WORKER_BACKOFF:
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
    if (plugin->removed.count && !plugin->listed) {
        catalog_restore(&plugin->pool->catalog, plugin->removed);
    } else if (!plugin->listed || w->given_up) {
        if (catalog_add(&plugin->pool->catalog, plugin->name, description, &e) < 0) {
            worker_fail(w, e.code, e.message, true);
            return;
        }
    }
    plugins_log_gaps(plugin->pool, description);
    if (!plugin->description)
        plugin->description = mem_strdup(description);
    if (w->given_up)
        log_info("the voice %s has started after all", plugin->name);
    w->given_up = false;
    worker_set_state(w, WORKER_IDLE, 0);
    plugin->settled = plugin->listed = true;
    plugin_settled(plugin);
    worker_take_next(w);
}

/* Handles the first frame of a process. */
static void worker_on_hello(struct worker *w, const struct wire_frame *frame) {
    struct wire_reader r = wire_read(frame);
    const char *text = wire_get_string(&r);
    w->absent = text && frame->type == WIRE_ABSENT;
    if (text && frame->type == WIRE_HELLO)
        hello(w, text);
    else
        worker_fail(w, ERROR_VOICE_FAILED,
                    text && (w->absent || frame->type == WIRE_FAILED) ? text : "sent garbage", true);
}

static void died(void *ctx, const char *how) {
    worker_fail(ctx, ERROR_VOICE_CRASHED, how, false);
}

static void gone(void *ctx) {
    struct worker *w = ctx;
    pool_handle_closed(w->plugin->pool);
}

/* Processor time for a task with that deadline. */
static uint32_t worker_processor_seconds(const struct voice_pool *pool, uint64_t ms) {
    double seconds = pool->processor * (double)ms / 1000;
    return seconds < PROCESSOR_SECONDS_MAX ? (uint32_t)seconds : PROCESSOR_SECONDS_MAX;
}

/* Retries later without blaming the plugin; its sentences wait. */
static void wait_for_resources(struct worker *w, const char *why) {
    struct voice_pool *pool = w->plugin->pool;
    uint64_t now = uv_now(pool->loop);
    if (now >= pool->no_room_logged + NO_ROOM_LOG_MS || !pool->no_room_logged) {
        log_warn("the voice %s has to wait: %s", w->plugin->name, why);
        pool->no_room_logged = now;
    }
    worker_set_state(w, WORKER_BACKOFF, NO_ROOM_MS);
}

/* Starts a process, releasing the descriptor reserve if needed. */
static struct process *launch(struct worker *w, struct error *e) {
    static const struct process_callbacks callbacks = {worker_on_frame, died, gone};
    struct voice_pool *pool = w->plugin->pool;
    struct process *process = NULL;
    if (w->plugin->queue) {
        pool->open_handles++;
        return remote_process_start(pool->loop, pool->work, w->plugin->queue, w->plugin->description,
                                    &callbacks, w);
    }
    reserve_fill(&pool->reserve);
    for (int i = 0; i < 2 && !process; i++) {
        pool->open_handles++;
        process = process_start(pool->loop, pool->worker_path, w->plugin->path, &callbacks, w, e);
        if (!process && e->code != PROCESS_RETRY)
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
    if (!w->process && e.code == PROCESS_RETRY) {
        wait_for_resources(w, e.message);
        return;
    }
    if (!w->process) {
        worker_fail(w, e.code, e.message, false);
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
    w->given_up = plugin->queue; /* until a remote worker appears */
    if (plugin->queue)
        w->state = WORKER_BACKOFF;
    else if (w->spare)
        turn_off(w, 0);
    else
        start(w);
}

void worker_remote_up(struct worker *w) {
    w->given_up = false;
    start(w);
}

void worker_remote_down(struct worker *w, const char *why) {
    struct error e;
    if (w->process)
        process_stop(w->process, false);
    w->process = NULL;
    w->given_up = true;
    worker_set_state(w, WORKER_BACKOFF, 0);
    error_set(&e, ERROR_VOICE_UNAVAILABLE, "the voice %s %s", w->plugin->name, why);
    end_job(w, NULL, &e);
}

/* Stops an idle spare. */
static void worker_retire(struct worker *w) {
    if (!regulars_idle(w->plugin)) {
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
    end_job(w, NULL, &e);
}
