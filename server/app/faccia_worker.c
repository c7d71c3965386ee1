/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia-worker: speaks for daemons elsewhere. It has no network of its own but the way to Redis. */
#include "server/app/service.h"
#include "server/app/settings.h"
#include "server/app/worker_hands.h"
#include "server/base/log.h"
#include "server/base/program.h"
#include "server/cluster/redis_work.h"
#include <signal.h>
#include <stdio.h>
#include <string.h>

enum { SIGNALS = 2, LOOK_MS = 50, GOODBYE_MS = 200 };

struct speaker {
    uv_loop_t loop;
    struct settings settings;
    struct voice_pool *pool;
    struct work_hands *hands;
    struct worker_hands *work;
    uv_signal_t signals[SIGNALS];
    uv_timer_t watchdog, ending;
    uint64_t end_by;
    bool draining, failed;
};

static void complain(const struct error *e) {
    char text[512];
    log_error("%s (%s)", error_text(e, text, sizeof text), error_name(e->code));
}

/* By now all that was given back is said. */
static void on_goodbye(uv_timer_t *timer) {
    struct speaker *p = timer->data;
    work_hands_close(p->hands);
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
    if (!worker_hands_busy(p->work) || uv_now(&p->loop) >= p->end_by)
        stop(p);
}

static void drain(struct speaker *p) {
    p->draining = true;
    p->end_by = uv_now(&p->loop) + (uint64_t)p->settings.stop_seconds * 1000;
    service_stopping();
    worker_hands_end(p->work);
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
    worker_hands_begin(p->work, p->pool, p->hands);
    work_hands_look(p->hands);
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

/* Nothing is kept here: the daemons have their caches, and their table of boundaries. */
static int start(struct speaker *p, struct error *e) {
    struct voice_pool_options voices = p->settings.voices;
    voices.cache = (struct cache_options){0};
    voices.boundaries = NULL;
    if (!p->settings.cluster || !*p->settings.cluster)
        return error_in_field(e, ERROR_BAD_FIELD, "--cluster", "is missing: where to take sentences from");
    p->work = worker_hands_new();
    p->hands = redis_hands_open(&p->loop, p->settings.cluster, &worker_hands_events, p->work, e);
    if (!p->hands)
        return -1;
    p->pool = voice_pool_open(&p->loop, &voices, on_ready, p, e);
    if (!p->pool) {
        work_hands_close(p->hands);
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
    worker_hands_free(p->work);
    return p->failed;
}

static void print_usage(void) {
    struct buf text = {0};
    buf_printf(&text,
               "Usage: faccia-worker --cluster URL [OPTION]...\nSpeaks with the voices of this machine for "
               "facciads elsewhere that share the same Redis.\n\n");
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
