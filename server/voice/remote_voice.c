/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>

struct remote_process {
    struct process process;
    struct work *work;
    const char *queue, *description;
    uv_timer_t pulse;
    bool greeted, stopped;
    enum work_turn priority;
    uint32_t quota_key;
    uint32_t job;           /* in progress; 0 = none */
    struct work_task *task; /* NULL once it is answered */
    struct process_callbacks callbacks;
    void *ctx;
};

static void say(struct remote_process *p, enum wire_type type, const struct buf *payload) {
    const struct wire_frame frame = {type, p->job, payload ? payload->data : (const uint8_t *)"",
                                     payload ? payload->size : 0};
    if (!p->stopped)
        p->callbacks.on_frame(p->ctx, &frame);
}

static void say_done(struct remote_process *p, enum error_code code, const char *text) {
    struct buf payload = {0};
    wire_put_u32(&payload, code);
    wire_put_string(&payload, text);
    uv_timer_stop(&p->pulse);
    say(p, WIRE_DONE, &payload);
    buf_free(&payload);
}

static void on_pulse(uv_timer_t *timer) {
    struct remote_process *p = timer->data;
    struct buf payload = {0};
    if (p->greeted) {
        say(p, p->task ? WIRE_WAITING : WIRE_ALIVE, NULL);
        return;
    }
    p->greeted = true;
    uv_timer_stop(timer);
    wire_put_string(&payload, p->description);
    say(p, WIRE_HELLO, &payload);
    buf_free(&payload);
}

static void die(struct remote_process *p, const char *how) {
    bool tell = !p->stopped;
    p->stopped = true;
    if (tell)
        p->callbacks.on_died(p->ctx, how);
    if (!uv_is_closing((uv_handle_t *)&p->pulse))
        process_stop(&p->process, false);
}

/* Delivers the recorded frames at once. Any of them may stop the process. */
static void say_again(struct remote_process *p, const struct buf *body) {
    struct wire_frame frame;
    size_t at = 0, used = 0;
    uint32_t job = p->job;
    while (!p->stopped && p->job == job && at < body->size) {
        if (wire_next(body->data + at, body->size - at, &frame, &used) != 1 ||
            (frame.type != WIRE_AUDIO && frame.type != WIRE_EVENTS)) {
            die(p, "sent garbage");
            return;
        }
        const struct buf payload = {(uint8_t *)frame.data, frame.size, 0};
        say(p, frame.type, &payload);
        at += used;
    }
}

static void on_answered(void *ctx, enum work_end end, const struct buf *body) {
    static const enum error_code codes[WORK_ENDS] = {
        [WORK_FAILED] = ERROR_VOICE_FAILED,    [WORK_CRASHED] = ERROR_VOICE_CRASHED,
        [WORK_TIMEOUT] = ERROR_VOICE_TIMEOUT,  [WORK_UNREACHED] = ERROR_VOICE_UNAVAILABLE,
        [WORK_FULL] = ERROR_VOICE_UNAVAILABLE,
    };
    struct remote_process *p = ctx;
    p->task = NULL;
    if (end == WORK_SPOKEN) {
        say_again(p, body);
        say_done(p, ERROR_NONE, "");
        return;
    }
    char *text = mem_strndup((const char *)body->data, body->size < 200 ? body->size : 200);
    say_done(p, codes[end], text);
    free(text);
}

static void speak(struct remote_process *p, const struct wire_frame *frame) {
    struct wire_reader r = wire_read(frame);
    (void)wire_get_u32(&r); /* processor time: the remote pool decides */
    const struct buf sentence = {(uint8_t *)r.at, (size_t)(r.end - r.at), 0};
    p->job = frame->job;
    p->task = work_put(p->work, p->queue, p->priority, p->quota_key, &sentence, on_answered, p);
    uv_timer_start(&p->pulse, on_pulse, WIRE_ALIVE_MS, WIRE_ALIVE_MS);
}

/* Reports the cancelled job as done, from a timer, because the caller does not expect it during the call. */
static void on_cancelled(uv_timer_t *timer) {
    struct remote_process *p = timer->data;
    say_done(p, ERROR_CANCELLED, "was told to stop");
}

static void send_remote(struct process *process, struct buf *b) {
    struct remote_process *p = (struct remote_process *)process;
    struct wire_frame frame;
    size_t used;
    if (wire_next(b->data, b->size, &frame, &used) == 1 && frame.type == WIRE_SPEAK) {
        speak(p, &frame);
    } else if (frame.type == WIRE_CANCEL && frame.job == p->job && p->task) {
        work_cancel(p->task);
        p->task = NULL;
        uv_timer_start(&p->pulse, on_cancelled, 0, 0);
    }
    b->size = 0;
}

static void on_closed(uv_handle_t *handle) {
    struct remote_process *p = handle->data;
    p->callbacks.on_closed(p->ctx);
    free(p);
}

static void stop_remote(struct process *process, bool politely) {
    struct remote_process *p = (struct remote_process *)process;
    (void)politely;
    p->stopped = true;
    work_cancel(p->task);
    p->task = NULL;
    if (!uv_is_closing((uv_handle_t *)&p->pulse))
        uv_close((uv_handle_t *)&p->pulse, on_closed);
}

static const struct process_ops remote_ops = {send_remote, stop_remote};

struct process *remote_process_start(uv_loop_t *loop, struct work *work, const char *queue,
                                     const char *description, const struct process_callbacks *callbacks,
                                     void *ctx) {
    struct remote_process *p = mem_alloc(sizeof *p);
    *p = (struct remote_process){.process = {&remote_ops},
                                 .work = work,
                                 .queue = queue,
                                 .description = description,
                                 .callbacks = *callbacks,
                                 .ctx = ctx};
    uv_timer_init(loop, &p->pulse);
    p->pulse.data = p;
    uv_timer_start(&p->pulse, on_pulse, 0, 0);
    return &p->process;
}

void remote_process_schedule(struct process *process, enum voice_priority priority, uint32_t quota_key) {
    static const enum work_turn priorities[] = {[VOICE_PRIORITY_NORMAL] = WORK_USUAL,
                                                [VOICE_PRIORITY_URGENT] = WORK_URGENT,
                                                [VOICE_PRIORITY_BACKGROUND] = WORK_AHEAD};
    struct remote_process *p = (struct remote_process *)process;
    p->priority = priorities[priority];
    p->quota_key = quota_key;
}

/* Plugins of remote workers: added when the first worker announces them, disabled when the last one goes.
 * A local plugin of the same name takes precedence while it runs. */

/* Sentences of this daemon that may be queued for one remote plugin. */
enum { SEATS = 64 };

static bool runs_here(const struct voice_pool *pool, const char *name) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        const struct plugin *plugin = &pool->plugins[i];
        if (!plugin->queue && plugin->listed && plugin_runs(plugin) && !strcmp(plugin->name, name))
            return true;
    }
    return false;
}

static struct plugin *plugin_of_queue(struct voice_pool *pool, const struct work_source *source) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        if (plugin->queue && !strcmp(plugin->queue, source->queue) && !strcmp(plugin->name, source->plugin))
            return plugin;
    }
    if (pool->plugin_count == pool->plugin_cap)
        return NULL; /* workers point into the list, so it must not be reallocated */
    struct plugin *plugin = &pool->plugins[pool->plugin_count++];
    *plugin = (struct plugin){.pool = pool,
                              .name = mem_strdup(source->plugin),
                              .queue = mem_strdup(source->queue),
                              .config = mem_strdup(source->queue), /* part of the cache key */
                              .description = mem_strdup(source->voices),
                              .worker_count = SEATS,
                              .seat_count = SEATS,
                              .settled = true};
    plugin->workers = mem_alloc(SEATS * sizeof *plugin->workers);
    for (size_t i = 0; i < SEATS; i++)
        worker_open(&plugin->workers[i], plugin);
    return plugin;
}

static void remote_up(struct plugin *plugin) {
    log_info("the voice %s is served by remote workers", plugin->name);
    plugin->available = true;
    for (size_t i = 0; i < plugin->seat_count; i++)
        worker_remote_up(&plugin->workers[i]);
}

static void remote_down(struct plugin *plugin) {
    static const char why[] = "has no remote worker left";
    log_warn("the voice %s %s", plugin->name, why);
    plugin->available = plugin->listed = false;
    if (!plugin->removed.count)
        plugin->removed = catalog_of_plugin(&plugin->pool->catalog, plugin->name);
    catalog_drop(&plugin->pool->catalog, plugin->name);
    for (size_t i = 0; i < plugin->seat_count; i++)
        worker_remote_down(&plugin->workers[i], why);
    queue_fail(&plugin->urgent, ERROR_VOICE_UNAVAILABLE, why);
    queue_fail(&plugin->normal, ERROR_VOICE_UNAVAILABLE, why);
    queue_fail(&plugin->background, ERROR_VOICE_UNAVAILABLE, why);
}

static bool is_among(const struct plugin *plugin, const struct work_source *sources, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(sources[i].queue, plugin->queue) && !strcmp(sources[i].plugin, plugin->name))
            return true;
    return false;
}

/* If two plugins share a name, the first one announced is used. */
static bool is_taken(const struct voice_pool *pool, const char *name) {
    for (size_t i = 0; i < pool->plugin_count; i++)
        if (pool->plugins[i].available && !strcmp(pool->plugins[i].name, name))
            return true;
    return runs_here(pool, name);
}

static void on_seen(void *ctx, const struct work_source *sources, size_t count) {
    struct voice_pool *pool = ctx;
    if (pool->closing)
        return;
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        if (plugin->available && !is_among(plugin, sources, count))
            remote_down(plugin);
    }
    for (size_t i = 0; i < count && pool->is_ready; i++) {
        if (is_taken(pool, sources[i].plugin))
            continue;
        struct plugin *plugin = plugin_of_queue(pool, &sources[i]);
        if (plugin)
            remote_up(plugin);
    }
}

void remote_voices_open(struct voice_pool *pool) {
    if (pool->work)
        work_watch(pool->work, on_seen, pool);
}

void remote_voices_close(struct voice_pool *pool) {
    if (pool->work)
        work_watch(pool->work, NULL, NULL);
}
