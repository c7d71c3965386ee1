/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facciad: the daemon. Puts the stages together on one loop, reads its settings anew on SIGHUP, and stops
 * cleanly when it is told to. */
#include "server/api/api.h"
#include "server/app/access_place.h"
#include "server/app/ahead_start.h"
#include "server/app/cluster_place.h"
#include "server/app/daemon_answer.h"
#include "server/app/daemon_offer.h"
#include "server/app/descriptors.h"
#include "server/app/library_place.h"
#include "server/app/service.h"
#include "server/app/settings.h"
#include "server/app/stages.h"
#include "server/app/tls_place.h"
#include "server/base/log.h"
#include "server/base/program.h"
#include "server/base/work_gate.h"
#include "server/codec/coder_pool.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIGNALS = 3,
    GOODBYE_MS = 200,
    LOOK_MS = 50,
    LONG_TEXT_BYTES = 16 << 10, /* takes half a millisecond to read */
};

struct daemon {
    uv_loop_t loop;
    int argc;
    char **argv;
    struct paths paths;
    struct settings settings;
    struct access_place access;
    struct tls_place tls;
    int *sockets; /* from systemd */
    unsigned socket_count;
    struct stages stages;
    struct reader reader; /* of what cannot be trusted */
    struct work_gate gate;
    struct metrics metrics;
    struct coder_pool *coders;
    struct codec_load codec_load;
    struct library *library; /* NULL = none */
    char *voice_config;      /* with the library's recordings; NULL: there are none */
    struct cluster_place place;
    struct speak_ahead *ahead;
    struct api *api;
    struct daemon_offer *offer;
    uv_signal_t signals[SIGNALS];
    uv_timer_t watchdog, ending;
    uint64_t end_by; /* loop time, ms */
    bool running, draining, dismissed, stopped, failed;
};

static void complain(const struct error *e) {
    char text[512];
    log_error("%s (%s)", error_text(e, text, sizeof text), error_name(e->code));
}

static void on_gestures(void *ctx) {
    struct daemon *d = ctx;
    struct error e;
    if (stages_load_expressions(&d->stages, &d->settings, &e))
        complain(&e);
}

/* The network's section, with what is no setting. */
static struct api_options net_options_of(struct daemon *d) {
    struct api_options options = d->settings.api;
    options.models = d->settings.models;
    options.library = d->library;
    options.reader = d->reader;
    options.gestures = d->settings.gestures;
    options.on_gestures = (struct document_store_listener){on_gestures, d};
    options.works = d->settings.library;
    options.http.listen_fds = d->sockets;
    options.http.listen_count = d->socket_count;
    options.http.tls = d->tls.on ? &d->tls.tls : NULL;
    options.secrets = d->access.secrets.count ? &d->access.secrets : NULL;
    options.revocations = &d->access.revocations;
    options.shares = d->place.cluster != NULL;
    options.bus = d->place.bus;
    options.board = d->place.board;
    options.http.connections_above = API_CONNECTIONS_ABOVE;
    descriptors_provide(&options.http, d->settings.voices.workers);
    return options;
}

static void stop(struct daemon *d);

static void on_ready(void *ctx) {
    struct daemon *d = ctx;
    char status[80];
    size_t count;
    voice_pool_voices(d->stages.pipeline.voices, &count);
    if (!count) {
        static const char none[] = "no voice plugin could be started";
        log_error(none);
        api_set_unavailable(d->api, none);
        return;
    }
    if (!synthesis_can_speak(&d->stages.pipeline, d->settings.lang)) {
        struct error e;
        error_in_field(&e, ERROR_UNKNOWN_LANGUAGE, "--lang", "no language '%s'", d->settings.lang);
        complain(&e);
        d->failed = true;
        stop(d);
        return;
    }
    api_set_ready(d->api);
    ahead_start(&d->ahead, &d->settings, &d->stages.pipeline, d->library);
    snprintf(status, sizeof status, "%zu voices, %zu language packs", count, d->stages.packs.count);
    log_info("ready: %s", status);
    service_ready(status);
}

/* The settings that do not wait for a restart. */
static void reload(struct daemon *d) {
    struct settings settings;
    struct settings_request request;
    struct access_place access = {0};
    struct error e;
    service_reloading();
    if (settings_read(&settings, &request, PROGRAM_DAEMON, d->argc, d->argv, &d->paths, &e) ||
        access_place_load(&access, &settings, &e)) {
        complain(&e);
        log_warn("the settings stay as they were");
        settings_free(&settings);
    } else if (d->access.secrets.count && !access.secrets.count) {
        log_warn("tokens cannot be given up while the daemon runs; the settings stay as they were");
        settings_free(&settings);
        access_place_free(&access);
    } else {
        struct settings old = d->settings;
        struct access_place old_access = d->access;
        d->settings = settings;
        d->access = access;
        struct api_options options = net_options_of(d);
        api_change(d->api, &options);
        d->stages.live.most = settings.heard_most;
        d->stages.live.payer_most = settings.heard_address;
        d->stages.live.seconds = settings.heard_seconds;
        log_open(settings_log_format(&d->settings));
        if (settings_need_restart(&old, &settings))
            log_warn(
                "changed settings of listen, speech, voices, library, paths or cluster wait for a restart");
        log_info("settings read anew");
        settings_follow(&d->settings, &old);
        access_place_free(&old_access);
    }
    service_ready("running");
}

static void stop(struct daemon *d) {
    if (d->stopped)
        return;
    d->stopped = true;
    if (d->api)
        api_close(d->api);
    speak_ahead_close(d->ahead);
    stages_stop_voices(&d->stages);
    cluster_place_close(&d->place);
    coder_pool_close(d->coders);
    if (!d->running)
        return;
    for (int i = 0; i < SIGNALS; i++)
        uv_close((uv_handle_t *)&d->signals[i], NULL);
    uv_close((uv_handle_t *)&d->ending, NULL);
    service_watchdog_stop(&d->watchdog);
}

/* Speech may go on until its end or the limit; then all are told goodbye, and a moment later it is over. */
static void on_ending(uv_timer_t *timer) {
    struct daemon *d = timer->data;
    if (d->dismissed) {
        stop(d);
    } else if (!api_busy(d->api) || uv_now(&d->loop) >= d->end_by) {
        d->dismissed = true;
        api_dismiss(d->api, error_name(ERROR_STOPPING));
        uv_timer_start(timer, on_ending, GOODBYE_MS, 0);
    }
}

static void drain(struct daemon *d) {
    d->draining = true;
    d->end_by = uv_now(&d->loop) + (uint64_t)d->settings.stop_seconds * 1000;
    service_stopping();
    api_drain(d->api);
    uv_timer_start(&d->ending, on_ending, 0, LOOK_MS);
}

static void on_signal(uv_signal_t *handle, int number) {
    struct daemon *d = handle->data;
    if (number == SIGHUP) {
        reload(d);
        return;
    }
    log_info("%s: stopping", strsignal(number));
    if (d->draining)
        stop(d);
    else
        drain(d);
}

static void watch(struct daemon *d) {
    static const int signals[SIGNALS] = {SIGTERM, SIGINT, SIGHUP};
    for (int i = 0; i < SIGNALS; i++) {
        uv_signal_init(&d->loop, &d->signals[i]);
        d->signals[i].data = d;
        uv_signal_start(&d->signals[i], on_signal, signals[i]);
    }
    uv_timer_init(&d->loop, &d->ending);
    d->ending.data = d;
    service_watchdog_start(&d->loop, &d->watchdog);
    d->running = true;
}

/* The files first, then the network, so that voices are started only where they can be asked. */
static int start(struct daemon *d, struct error *e) {
    const struct settings *s = &d->settings;
    struct voice_pool_options voices = s->voices;
    struct pipeline *pipeline = &d->stages.pipeline;
    if (access_place_load(&d->access, s, e) || tls_place_open(&d->tls, s, e) ||
        stages_load(&d->stages, s, STAGES_ALL, &d->loop, e))
        return -1;
    if (!speech_packs_find(&d->stages.packs, s->lang))
        return error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "--lang", "no language '%s'", s->lang);
    if (library_place_open(s, &d->paths, &d->library, &d->voice_config, e) ||
        cluster_place_open(s, &d->loop, &d->metrics, &d->place, e))
        return -1;
    voices.cluster = d->place.cluster;
    voices.work = d->place.work;
    if (d->voice_config)
        voices.config = d->voice_config;
    pipeline->metrics = voices.metrics = &d->metrics;
    pipeline->codec_load = &d->codec_load;
    pipeline->long_text = LONG_TEXT_BYTES;
    d->reader = (struct reader){d->paths.reader, s->voices.unconfined};
    pipeline->reader = &d->reader;
    pipeline->gate = &d->gate;
    pipeline->open_seconds = s->api.open_seconds;
    struct api_options options = net_options_of(d);
    d->offer = daemon_offer_new(pipeline);
    const struct offer_source offer = daemon_offer_source(d->offer);
    d->api = api_open(pipeline, &offer, &options, e);
    if (!d->api)
        return -1;
    pipeline->coders = d->coders = coder_pool_open(&d->loop, 0);
    codec_load_open(&d->codec_load, &d->loop, d->coders, &d->metrics);
    if (stages_start_voices(&d->stages, &voices, on_ready, d, e))
        return -1;
    watch(d);
    return 0;
}

static void log_addresses(const struct daemon *d) {
    struct buf text = {0};
    for (size_t i = 0; api_address(d->api, i, &text); i++) {
        log_info("listening on %.*s", (int)text.size, (const char *)text.data);
        buf_free(&text);
    }
}

static int run(struct daemon *d) {
    struct error e;
    uv_loop_init(&d->loop);
    int status = start(d, &e) ? 1 : 0;
    if (status) {
        complain(&e);
        stop(d);
    } else {
        log_addresses(d);
    }
    uv_run(&d->loop, UV_RUN_DEFAULT);
    if (d->failed)
        status = 1;
    if (d->api)
        api_free(d->api);
    library_close(d->library);
    free(d->voice_config);
    daemon_offer_free(d->offer);
    uv_loop_close(&d->loop);
    stages_free(&d->stages);
    access_place_free(&d->access);
    tls_place_free(&d->tls);
    return status;
}

int main(int argc, char **argv) {
    struct daemon d = {.argc = argc, .argv = argv};
    struct settings_request request;
    struct error e;
    char text[512];
    int status;
    program_begin();
    paths_find(&d.paths);
    if (settings_read(&d.settings, &request, PROGRAM_DAEMON, argc, argv, &d.paths, &e)) {
        fprintf(stderr, "facciad: %s (%s)\n", error_text(&e, text, sizeof text), error_name(e.code));
        status = 2;
    } else if ((status = daemon_answer(&d.settings, &request)) < 0) {
        log_open(settings_log_format(&d.settings));
        d.socket_count = service_sockets(&d.sockets);
        status = run(&d);
    }
    settings_free(&d.settings);
    paths_free(&d.paths);
    free(d.sockets);
    return status;
}
