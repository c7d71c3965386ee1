/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facciad: the daemon. Puts the stages together on one loop, reads its settings anew on SIGHUP, and stops
 * cleanly when it is told to. */
#include "server/app/daemon_offer.h"
#include "server/app/descriptors.h"
#include "server/app/service.h"
#include "server/app/settings.h"
#include "server/base/log.h"
#include "server/net/net.h"
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
    struct secrets secrets;
    char *voice_config;
    int *sockets; /* from systemd */
    unsigned socket_count;
    struct speech_packs packs;
    struct expressions *expressions;
    struct face_high_level *high_level;
    struct normalizers normalizers;
    struct metrics metrics;
    struct coder_pool *coders;
    struct codec_load codec_load;
    struct pipeline pipeline;
    struct net *net;
    struct daemon_offer *offer;
    uv_signal_t signals[SIGNALS];
    uv_timer_t watchdog, ending;
    uint64_t end_by; /* loop time, ms */
    bool running, draining, dismissed, stopped, failed;
};

static void complain(const struct error *e) {
    char text[512];
    log_error("%s", error_text(e, text, sizeof text));
}

static struct net_options net_options_of(const struct daemon *d) {
    const struct settings *s = &d->settings;
    struct net_options options = {
        .host = s->host,
        .port = (int)s->port,
        .remote = s->remote,
        .listen_fds = d->sockets,
        .listen_count = d->socket_count,
        .origins = s->origins,
        .host_names = s->host_names,
        .embed = s->embed,
        .secrets = d->secrets.count ? &d->secrets : NULL,
        .web = s->web,
        .models = s->models,
        .media = s->media,
        .text_bytes = s->text_bytes,
        .message_bytes = s->message_bytes,
        .play_bytes = s->play_bytes,
        .queue = s->queue,
        .connections = s->connections,
        .connections_above = NET_CONNECTIONS_ABOVE,
        .rooms = s->rooms,
        .address_connections = s->address_connections,
        .address_requests = s->address_requests,
        .send_bytes = s->send_bytes,
        .send_bytes_max = s->send_bytes_max,
        .lag_seconds = s->lag_seconds,
        .stall_seconds = s->stall_seconds,
        .ping_seconds = s->ping_seconds,
        .hold_seconds = s->hold_seconds,
    };
    descriptors_provide(&options, s->workers);
    return options;
}

static void stop(struct daemon *d);

static void on_ready(void *ctx) {
    struct daemon *d = ctx;
    char status[80];
    size_t count;
    voice_pool_voices(d->pipeline.voices, &count);
    if (!count) {
        static const char none[] = "no voice plugin could be started";
        log_error(none);
        net_set_unavailable(d->net, none);
        return;
    }
    if (!synthesis_can_speak(&d->pipeline, d->settings.lang)) {
        struct error e;
        error_in_field(&e, "unknown-language", "--lang", "no language '%s'", d->settings.lang);
        complain(&e);
        d->failed = true;
        stop(d);
        return;
    }
    net_set_ready(d->net);
    snprintf(status, sizeof status, "%zu voices, %zu language packs", count, d->packs.count);
    log_info("ready: %s", status);
    service_ready(status);
}

/* The settings that do not wait for a restart. */
static void reload(struct daemon *d) {
    struct settings settings;
    struct settings_request request;
    struct secrets secrets = {0};
    struct error e;
    service_reloading();
    if (settings_read(&settings, &request, d->argc, d->argv, &d->paths, &e) ||
        (settings.token_file && secrets_load(&secrets, settings.token_file, &e))) {
        complain(&e);
        log_warn("the settings stay as they were");
        settings_free(&settings);
    } else if (d->secrets.count && !secrets.count) {
        log_warn("tokens cannot be given up while the daemon runs; the settings stay as they were");
        settings_free(&settings);
    } else {
        struct settings old = d->settings;
        struct secrets old_secrets = d->secrets;
        d->settings = settings;
        d->secrets = secrets;
        struct net_options options = net_options_of(d);
        net_change(d->net, &options);
        settings_apply_log(&d->settings);
        if (settings_need_restart(&old, &settings))
            log_warn(
                "some of the changed settings count after a restart only: those of listen, speech, voices, "
                "paths");
        log_info("settings read anew");
        settings_free(&old);
        secrets_free(&old_secrets);
    }
    service_ready("running");
}

static void stop(struct daemon *d) {
    if (d->stopped)
        return;
    d->stopped = true;
    if (d->net)
        net_close(d->net);
    if (d->pipeline.voices)
        voice_pool_close(d->pipeline.voices, NULL, NULL);
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
    } else if (!net_busy(d->net) || uv_now(&d->loop) >= d->end_by) {
        d->dismissed = true;
        net_dismiss(d->net, "stopping");
        uv_timer_start(timer, on_ending, GOODBYE_MS, 0);
    }
}

static void drain(struct daemon *d) {
    d->draining = true;
    d->end_by = uv_now(&d->loop) + (uint64_t)d->settings.stop_seconds * 1000;
    service_stopping();
    net_drain(d->net);
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

static int start(struct daemon *d, struct error *e) {
    const struct settings *s = &d->settings;
    char path[4096];
    if (s->token_file && secrets_load(&d->secrets, s->token_file, e))
        return -1;
    snprintf(path, sizeof path, "%s/speech", s->models);
    if (speech_packs_load(&d->packs, path, e))
        return -1;
    if (!speech_packs_find(&d->packs, s->lang))
        return error_in_field(e, "unknown-language", "--lang", "no language '%s'", s->lang);
    snprintf(path, sizeof path, "%s/expressions.json", s->models);
    d->expressions = expressions_load(path, e);
    if (!d->expressions)
        return -1;
    snprintf(path, sizeof path, "%s/normalization", s->models);
    if (normalizers_load(&d->normalizers, path, e))
        return -1;
    d->high_level = face_high_level_new(speech_packs_find(&d->packs, SPEECH_PACK_GENERAL), d->expressions);
    d->pipeline = (struct pipeline){.loop = &d->loop,
                                    .packs = &d->packs,
                                    .expressions = d->expressions,
                                    .high_level = d->high_level,
                                    .normalizers = &d->normalizers,
                                    .default_lang = s->lang,
                                    .default_contacts = !strcmp(s->contacts, "on")    ? CONTACTS_ON
                                                        : !strcmp(s->contacts, "off") ? CONTACTS_OFF
                                                                                      : CONTACTS_ENGINE,
                                    .sounds = s->audio,
                                    .metrics = &d->metrics,
                                    .codec_load = &d->codec_load,
                                    .long_text = LONG_TEXT_BYTES};
    struct net_options options = net_options_of(d);
    d->offer = daemon_offer_new(&d->pipeline);
    const struct offer_source offer = daemon_offer_source(d->offer);
    d->net = net_open(&d->pipeline, &offer, &options, e);
    if (!d->net)
        return -1;
    d->pipeline.coders = d->coders = coder_pool_open(&d->loop, 0);
    codec_load_open(&d->codec_load, &d->loop, d->coders, &d->metrics);
    d->voice_config = s->voices ? json_dumps(s->voices, JSON_COMPACT) : NULL;
    struct voice_pool_options voices = {.worker = s->worker,
                                        .plugin_dir = s->plugins,
                                        .workers = s->workers,
                                        .spare_workers = s->spare_workers,
                                        .start_seconds = s->start_seconds,
                                        .deadline_base = s->deadline_base,
                                        .deadline_per_byte = s->deadline_per_byte,
                                        .deadline_most = s->deadline_most,
                                        .processor = s->worker_processor,
                                        .megabytes = s->worker_megabytes,
                                        .unconfined = !strcmp(s->sandbox, "off"),
                                        .config = d->voice_config,
                                        .cache = {.bytes = (size_t)s->cache_megabytes << 20,
                                                  .file = s->cache_file,
                                                  .file_bytes = (uint64_t)s->cache_file_megabytes << 20},
                                        .metrics = &d->metrics};
    d->pipeline.voices = voice_pool_open(&d->loop, &voices, on_ready, d, e);
    if (!d->pipeline.voices)
        return -1;
    watch(d);
    return 0;
}

static void log_addresses(const struct daemon *d) {
    struct buf text = {0};
    for (size_t i = 0; net_address(d->net, i, &text); i++) {
        log_info("listening on %.*s", (int)text.size, (const char *)text.data);
        buf_free(&text);
    }
}

static int run(struct daemon *d) {
    struct error e;
    signal(SIGPIPE, SIG_IGN);
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
    if (d->net)
        net_free(d->net);
    daemon_offer_free(d->offer);
    uv_loop_close(&d->loop);
    speech_packs_free(&d->packs);
    expressions_free(d->expressions);
    face_high_level_free(d->high_level);
    normalizers_free(&d->normalizers);
    secrets_free(&d->secrets);
    free(d->voice_config);
    return status;
}

/* What can be answered without starting; -1 to go on. */
static int answer(const struct settings *settings, const struct settings_request *request) {
    struct buf text = {0};
    if (request->help)
        settings_help(&text);
    else if (request->version)
        buf_printf(&text, "facciad " FACCIA_VERSION "\n");
    else if (request->print)
        settings_print(settings, &text);
    else
        return -1;
    fwrite(text.data, 1, text.size, stdout);
    buf_free(&text);
    return 0;
}

int main(int argc, char **argv) {
    struct daemon d = {.argc = argc, .argv = argv};
    struct settings_request request;
    struct error e;
    char text[512];
    int status;
    paths_find(&d.paths);
    if (settings_read(&d.settings, &request, argc, argv, &d.paths, &e)) {
        fprintf(stderr, "facciad: %s\n", error_text(&e, text, sizeof text));
        status = 2;
    } else if ((status = answer(&d.settings, &request)) < 0) {
        settings_apply_log(&d.settings);
        d.socket_count = service_sockets(&d.sockets);
        status = run(&d);
    }
    settings_free(&d.settings);
    paths_free(&d.paths);
    free(d.sockets);
    return status;
}
