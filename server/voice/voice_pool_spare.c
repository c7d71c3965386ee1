/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spare workers: one that has fallen silent (its process was stopped, or gets no processor), or that takes
 * long over one sentence, does not hold up the sentences of others. */
#include "server/base/log.h"
#include "server/voice/voice_pool_internal.h"

/* While it works it shows a sign of life every WIRE_ALIVE_MS. Looks are counted, not milliseconds: when the
 * daemon itself was held up, it looks once and then hears all that has come meanwhile. */
enum { LOOK_MS = WIRE_ALIVE_MS, SILENT_LOOKS = 3, BUSY_LOOKS = 4 };

static bool is_silent(const struct worker *w) {
    return w->state == WORKER_SPEAKING && w->silent >= SILENT_LOOKS;
}

bool spare_is_stuck(const struct worker *w) {
    return w->state == WORKER_LOST || w->state == WORKER_OFF || is_silent(w);
}

static void on_look(uv_timer_t *timer) {
    struct worker *w = timer->data;
    struct plugin *plugin = w->plugin;
    if (w->state != WORKER_SPEAKING || plugin->pool->closing) {
        uv_timer_stop(timer);
        return;
    }
    bool others = plugin->urgent.first || plugin->waiting.first;
    bool slow = w->job->voice->capabilities & FACCIA_VOICE_SLOW; /* it would have less of the processors */
    w->looks++;
    w->silent++;
    if (is_silent(w) || (others && !slow && w->looks >= BUSY_LOOKS))
        spare_call(plugin);
}

void spare_watch(struct worker *w) {
    w->looks = w->silent = 0;
    uv_timer_start(&w->pulse, on_look, LOOK_MS, LOOK_MS);
}

void spare_heard(struct worker *w) {
    w->silent = 0;
}

/* Not when one is on its way already. Those that have fallen silent do not count. */
void spare_call(struct plugin *plugin) {
    struct worker *spare = NULL;
    size_t active = 0;
    for (size_t i = 0; i < plugin->seat_count; i++) {
        struct worker *w = &plugin->workers[i];
        if (w->state == WORKER_IDLE) {
            worker_wake(w);
            return;
        }
        if (w->state == WORKER_STARTING)
            return;
        active += !spare_is_stuck(w);
        if (w->state == WORKER_OFF && w->not_before <= uv_now(plugin->pool->loop))
            spare = w;
    }
    if (!spare || active >= plugin->worker_count + plugin->spare_count)
        return;
    log_info("the voice %s is held up by a sentence; a spare worker is started", plugin->name);
    worker_start(spare);
}

/* One that a second worker has fallen silent over stays where it is: it may be the sentence. It waits behind
 * those that it has held up, as it may take long. */
void spare_rescue(struct plugin *plugin) {
    for (size_t i = 0; i < plugin->seat_count; i++) {
        struct worker *w = &plugin->workers[i];
        if (!is_silent(w) || w->job->moved)
            continue;
        struct voice_job *job = worker_give_up_job(w);
        job->moved = true;
        job_push(job_queue_of(job), job);
    }
}

bool spare_may_go(const struct plugin *plugin) {
    for (size_t i = 0; i < plugin->worker_count; i++)
        if (plugin->workers[i].state != WORKER_IDLE)
            return false;
    return true;
}
