/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/cluster/cluster.h"
#include "server/daemon/service.h"
#include "server/daemon/settings.h"
#include "server/voice/voice_pool.h"
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- worker side: offers this machine's voices to the work queue and speaks its sentences ---- */

struct worker_side;

extern const struct work_consumer_events worker_side_events;

enum { PLUGINS_MOST = 64 };

/* A plugin's voices, and the number of its sentences in progress. */
struct voice_queue {
    size_t plugin; /* index in the pool */
    char queue[CLUSTER_HASH_BYTES];
    char *voices;
    unsigned live, ahead;
};

struct worker_side {
    struct voice_pool *pool;
    struct work_consumer *consumer;
    struct voice_queue list[PLUGINS_MOST];
    size_t count;
    struct work_offer offers[PLUGINS_MOST];
    bool ended;
};

struct sentence {
    struct worker_side *w;
    struct work_item *item;
    struct voice_queue *queue;
    struct voice_job *job;
    struct buf frames;
    bool whole; /* all audio went out as frames */
};

/* Describes the voices without members that concern this machine only. */
static char *voices_of(const struct voice_plugin *plugin) {
    json_t *root = json_loads(plugin->description, 0, NULL);
    json_object_del(root, "gaps");
    char *text = json_dumps(root, JSON_COMPACT | JSON_SORT_KEYS);
    json_decref(root);
    return text ? text : mem_strdup("");
}

/* Names the queue by a hash of plugin, file and configuration, so that machines with the same voices share
 * it. Hashing keeps secrets in the configuration here. */
static void name_queue(struct voice_queue *queue, const struct voice_plugin *plugin) {
    char form[WORK_FORM_BYTES + 1];
    struct buf key = {0};
    work_form(form);
    buf_printf(&key, "%s\n%s\n%s\n%s\n%s", form, plugin->name, plugin->edition, plugin->config,
               queue->voices);
    cluster_hash_of(&key, queue->queue);
    buf_free(&key);
}

static struct voice_queue *queue_of(struct worker_side *w, size_t index, const struct voice_plugin *plugin) {
    for (size_t i = 0; i < w->count; i++)
        if (w->list[i].plugin == index)
            return &w->list[i];
    if (w->count == PLUGINS_MOST)
        return NULL;
    struct voice_queue *queue = &w->list[w->count++];
    queue->plugin = index;
    queue->voices = voices_of(plugin);
    name_queue(queue, plugin);
    log_info("serves the voice %s", plugin->name);
    return queue;
}

static size_t offers(void *ctx, const struct work_offer **out) {
    struct worker_side *w = ctx;
    struct voice_plugin plugin;
    size_t count = 0;
    *out = w->offers;
    for (size_t i = 0; w->pool && !w->ended && voice_pool_plugin(w->pool, i, &plugin); i++) {
        struct voice_queue *queue = plugin.runs && plugin.description ? queue_of(w, i, &plugin) : NULL;
        if (!queue)
            continue;
        unsigned all = queue->live + queue->ahead;
        w->offers[count++] = (struct work_offer){
            .source = {queue->queue, plugin.name, queue->voices},
            .live = plugin.seats > queue->live ? plugin.seats - queue->live
                                               : 0, /* prerendered sentences give way */
            .ahead = plugin.seats > all ? plugin.seats - all : 0,
        };
    }
    return count;
}

static unsigned *count_of(struct sentence *s) {
    return s->item->turn == WORK_AHEAD ? &s->queue->ahead : &s->queue->live;
}

static void forget(struct sentence *s) {
    buf_free(&s->frames);
    free(s);
}

static void on_frames(void *ctx, const struct buf *frames) {
    struct sentence *s = ctx;
    s->whole = true;
    buf_add(&s->frames, frames->data, frames->size);
}

static void end(struct sentence *s, enum work_end how, const char *why) {
    struct worker_side *w = s->w;
    const struct buf text = {(uint8_t *)why, why ? strlen(why) : 0, 0};
    --*count_of(s);
    work_answer(s->item, how, why ? &text : &s->frames);
    forget(s);
    work_consumer_look(w->consumer);
}

static void on_done(void *ctx, struct sentence_audio *audio) {
    struct sentence *s = ctx;
    sentence_audio_free(audio);
    if (s->whole)
        end(s, WORK_SPOKEN, NULL);
    else
        end(s, WORK_FAILED, "produced more than can be sent");
}

/* The sentence gave way to a live one or this worker is ending: another worker speaks it. */
static void on_failed(void *ctx, const struct error *e) {
    struct sentence *s = ctx;
    if (e->code != ERROR_CANCELLED) {
        end(s,
            e->code == ERROR_VOICE_CRASHED   ? WORK_CRASHED
            : e->code == ERROR_VOICE_TIMEOUT ? WORK_TIMEOUT
                                             : WORK_FAILED,
            e->message);
        return;
    }
    --*count_of(s);
    work_give_back(s->item);
    forget(s);
}

static void on_taken(void *ctx, struct work_item *item) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    static const enum voice_priority turns[WORK_TURNS] = {VOICE_PRIORITY_URGENT, VOICE_PRIORITY_NORMAL,
                                                          VOICE_PRIORITY_BACKGROUND};
    struct worker_side *w = ctx;
    struct error e;
    struct sentence *s = mem_alloc(sizeof *s);
    s->w = w;
    s->item = item;
    item->mine = s;
    for (size_t i = 0; i < w->count; i++)
        if (!strcmp(w->list[i].queue, item->queue))
            s->queue = &w->list[i];
    ++*count_of(s);
    s->job = voice_pool_speak_frames(w->pool, s->queue->plugin, &item->sentence, turns[item->turn], on_frames,
                                     &callbacks, s, &e);
    if (s->job)
        return;
    log_warn("cluster: cannot speak a queue entry: %s", e.message);
    end(s, WORK_FAILED, e.message);
}

static void on_lost(void *ctx, struct work_item *item) {
    struct sentence *s = item->mine;
    (void)ctx;
    log_info("a sentence has been claimed by another worker, or is no longer needed");
    voice_job_cancel(s->job);
    --*count_of(s);
    forget(s);
}

const struct work_consumer_events worker_side_events = {offers, on_taken, on_lost};

static struct worker_side *worker_side_new(void) {
    return mem_alloc(sizeof(struct worker_side));
}

static void worker_side_free(struct worker_side *w) {
    for (size_t i = 0; w && i < w->count; i++)
        free(w->list[i].voices);
    free(w);
}

/* Starts to offer the pool's voices. */
static void worker_side_begin(struct worker_side *w, struct voice_pool *pool,
                              struct work_consumer *consumer) {
    w->pool = pool;
    w->consumer = consumer;
}

/* Stops taking sentences. */
static void worker_side_end(struct worker_side *w) {
    w->ended = true;
}

/* Number of sentences in progress. */
static size_t worker_side_busy(const struct worker_side *w) {
    size_t busy = 0;
    for (size_t i = 0; i < w->count; i++)
        busy += w->list[i].live + w->list[i].ahead;
    return busy;
}

/* faccia-worker: speaks for daemons on other machines. Its only network connection is to Redis. */

enum { SIGNALS = 2, LOOK_MS = 50, GOODBYE_MS = 200 };

struct speaker {
    uv_loop_t loop;
    struct settings settings;
    struct voice_pool *pool;
    struct work_consumer *consumer;
    struct worker_side *work;
    uv_signal_t signals[SIGNALS];
    uv_timer_t watchdog, ending;
    uint64_t end_by;
    bool draining, failed;
};

static void complain(const struct error *e) {
    char text[512];
    log_error("%s (%s)", error_text(e, text, sizeof text), error_name(e->code));
}

/* By now the returned sentences have been sent. */
static void on_goodbye(uv_timer_t *timer) {
    struct speaker *p = timer->data;
    work_consumer_close(p->consumer);
    for (int i = 0; i < SIGNALS; i++)
        uv_close((uv_handle_t *)&p->signals[i], NULL);
    uv_close((uv_handle_t *)&p->ending, NULL);
    service_watchdog_stop(&p->watchdog);
}

static void stop(struct speaker *p) {
    if (p->pool)
        voice_pool_close(p->pool, NULL, NULL);
    p->pool = NULL;
    uv_timer_start(&p->ending, on_goodbye, GOODBYE_MS, 0);
}

static void on_ending(uv_timer_t *timer) {
    struct speaker *p = timer->data;
    if (!worker_side_busy(p->work) || uv_now(&p->loop) >= p->end_by)
        stop(p);
}

static void drain(struct speaker *p) {
    p->draining = true;
    p->end_by = uv_now(&p->loop) + (uint64_t)p->settings.stop_seconds * 1000;
    service_stopping();
    worker_side_end(p->work);
    uv_timer_start(&p->ending, on_ending, 0, LOOK_MS);
}

static void on_signal(uv_signal_t *handle, int number) {
    struct speaker *p = handle->data;
    log_info("%s: stopping", strsignal(number));
    if (!p->draining)
        drain(p);
    else if (p->pool)
        stop(p);
}

static void on_ready(void *ctx) {
    struct speaker *p = ctx;
    char status[80];
    size_t count;
    voice_pool_voices(p->pool, &count);
    if (!count) {
        log_error("no voice plugin could be started");
        p->failed = true;
        drain(p);
        return;
    }
    snprintf(status, sizeof status, "%zu voices", count);
    log_info("ready: %s", status);
    service_ready(status);
    worker_side_begin(p->work, p->pool, p->consumer);
    work_consumer_look(p->consumer);
}

static void watch(struct speaker *p) {
    static const int signals[SIGNALS] = {SIGTERM, SIGINT};
    for (int i = 0; i < SIGNALS; i++) {
        uv_signal_init(&p->loop, &p->signals[i]);
        p->signals[i].data = p;
        uv_signal_start(&p->signals[i], on_signal, signals[i]);
    }
    uv_timer_init(&p->loop, &p->ending);
    p->ending.data = p;
    service_watchdog_start(&p->loop, &p->watchdog);
}

/* Nothing is cached here: the daemons have caches and boundary tables. */
static int start(struct speaker *p, struct error *e) {
    struct voice_pool_options voices = p->settings.voices;
    voices.cache = (struct cache_options){0};
    voices.boundaries = NULL;
    if (!p->settings.cluster || !*p->settings.cluster)
        return error_in_field(e, ERROR_BAD_FIELD, "--cluster",
                              "is missing: the Redis to take sentences from");
    p->work = worker_side_new();
    p->consumer = work_consumer_open(&p->loop, p->settings.cluster, &worker_side_events, p->work, e);
    if (!p->consumer)
        return -1;
    p->pool = voice_pool_open(&p->loop, &voices, on_ready, p, e);
    if (!p->pool) {
        work_consumer_close(p->consumer);
        return -1;
    }
    watch(p);
    return 0;
}

static int run(struct speaker *p) {
    struct error e;
    signal(SIGHUP, SIG_IGN);
    uv_loop_init(&p->loop);
    p->failed = start(p, &e) != 0;
    if (p->failed)
        complain(&e);
    uv_run(&p->loop, UV_RUN_DEFAULT);
    uv_loop_close(&p->loop);
    worker_side_free(p->work);
    return p->failed;
}

static void print_usage(void) {
    struct buf text = {0};
    buf_printf(&text, "Usage: faccia-worker --cluster URL [OPTION]...\nServes the voices of this machine to "
                      "facciads on other machines that share the same Redis.\n\n");
    settings_help(PROGRAM_WORKER, &text);
    fwrite(text.data, 1, text.size, stdout);
    buf_free(&text);
}

int main(int argc, char **argv) {
    struct speaker p = {0};
    struct settings_request request;
    struct paths paths;
    struct error e;
    char text[512];
    int status = 0;
    program_begin();
    paths_find(&paths);
    if (settings_read(&p.settings, &request, PROGRAM_WORKER, argc, argv, &paths, &e)) {
        fprintf(stderr, "faccia-worker: %s (%s)\n", error_text(&e, text, sizeof text), error_name(e.code));
        status = 2;
    } else if (request.help) {
        print_usage();
    } else if (request.version) {
        puts("faccia-worker " FACCIA_VERSION);
    } else {
        log_open(settings_log_format(&p.settings));
        status = run(&p);
    }
    settings_free(&p.settings);
    paths_free(&paths);
    return status;
}
