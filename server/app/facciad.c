/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facciad: the daemon. Puts the stages together on one loop, and stops cleanly when it is told to. */
#include "server/base/log.h"
#include "server/base/paths.h"
#include "server/net/net.h"
#include "server/voice/config.h"
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct daemon {
    uv_loop_t loop;
    struct paths paths;
    struct speech_packs packs;
    struct studio studio;
    struct net *net;
    uv_signal_t stop_signals[2];
    bool signals_set, stopping;
};

struct daemon_options {
    struct net_options net;
    struct voice_pool_options voices;
    const char *lang;
};

static const char usage[] =
    "Usage: facciad [OPTION]...\n"
    "Serves the talking head: a page, a WebSocket and HTTP (protocol/README.md says how).\n"
    "\n"
    "      --host ADDRESS        listen on this address (127.0.0.1)\n"
    "      --port N              listen on this port; 0 = any free one (8080)\n"
    "      --remote              allow an ADDRESS that other machines can reach\n"
    "      --lang TAG            language of requests that name none (it)\n"
    "      --workers N           processes for each voice plugin, 1 to 64 (1)\n"
    "      --max-text N          longest text of one request, bytes (100000)\n"
    "      --max-message N       longest message of a client, bytes (262144)\n"
    "      --max-queue N         utterances that may wait on one stream (32)\n"
    "      --max-connections N   open connections (1000)\n"
    "      --models DIR          heads and language packs\n"
    "      --web DIR             the page and its scripts\n"
    "      --plugins DIR         voice plugins\n"
    "      --voice-config FILE   what the voice plugins are told, JSON (server/plugins/README.md)\n"
    "  -h, --help                print this and exit\n"
    "      --version             print the version and exit\n";

/* A whole number in its range, or the end with a message. */
static unsigned number(const char *option, const char *text, unsigned long min, unsigned long max) {
    char *end;
    unsigned long value = strtoul(text, &end, 10);
    if (*end || end == text || *text == '-' || value < min || value > max) {
        fprintf(stderr, "facciad: --%s: '%s' is not a number from %lu to %lu\n", option, text, min, max);
        exit(2);
    }
    return (unsigned)value;
}

static void replace(char **path, const char *with) {
    free(*path);
    *path = strdup(with);
}

static void parse(int argc, char **argv, struct daemon_options *o, struct paths *paths) {
    enum {
        HOST = 256,
        PORT,
        REMOTE,
        LANG,
        WORKERS,
        TEXT,
        MESSAGE,
        QUEUE,
        CONNECTIONS,
        MODELS,
        WEB,
        PLUGINS,
        VOICE_CONFIG,
        VERSION
    };
    static const struct option options[] = {
        {"host", 1, NULL, HOST},
        {"port", 1, NULL, PORT},
        {"remote", 0, NULL, REMOTE},
        {"lang", 1, NULL, LANG},
        {"workers", 1, NULL, WORKERS},
        {"max-text", 1, NULL, TEXT},
        {"max-message", 1, NULL, MESSAGE},
        {"max-queue", 1, NULL, QUEUE},
        {"max-connections", 1, NULL, CONNECTIONS},
        {"models", 1, NULL, MODELS},
        {"web", 1, NULL, WEB},
        {"plugins", 1, NULL, PLUGINS},
        {"voice-config", 1, NULL, VOICE_CONFIG},
        {"help", 0, NULL, 'h'},
        {"version", 0, NULL, VERSION},
        {0},
    };
    for (int c, at; (at = 0, c = getopt_long(argc, argv, "h", options, &at)) != -1;) {
        const char *name = options[at].name;
        switch (c) {
        case HOST:
            o->net.host = optarg;
            break;
        case PORT:
            o->net.port = (int)number(name, optarg, 0, 65535);
            break;
        case REMOTE:
            o->net.remote = true;
            break;
        case LANG:
            o->lang = optarg;
            break;
        case WORKERS:
            o->voices.workers = number(name, optarg, 1, 64);
            break;
        case TEXT:
            o->net.text_bytes = number(name, optarg, 1, 100 << 20);
            break;
        case MESSAGE:
            o->net.message_bytes = number(name, optarg, 64, 200 << 20);
            break;
        case QUEUE:
            o->net.queue = number(name, optarg, 1, 10000);
            break;
        case CONNECTIONS:
            o->net.connections = number(name, optarg, 1, 100000);
            break;
        case MODELS:
            replace(&paths->models, optarg);
            break;
        case WEB:
            replace(&paths->web, optarg);
            break;
        case PLUGINS:
            replace(&paths->plugins, optarg);
            break;
        case VOICE_CONFIG:
            replace(&paths->voice_config, optarg);
            break;
        case 'h':
            fputs(usage, stdout);
            exit(0);
        case VERSION:
            puts("facciad " FACCIA_VERSION);
            exit(0);
        default:
            fputs("Try 'facciad --help'.\n", stderr);
            exit(2);
        }
    }
    if (optind < argc) {
        fprintf(stderr, "facciad: unexpected '%s'\nTry 'facciad --help'.\n", argv[optind]);
        exit(2);
    }
}

static void on_ready(void *ctx) {
    struct daemon *d = ctx;
    size_t count;
    voice_pool_voices(d->studio.voices, &count);
    if (!count) {
        log_error("no voice plugin could be started");
        return;
    }
    net_set_ready(d->net);
    log_info("ready: %zu voices, %zu languages", count, d->packs.count);
}

static void stop(struct daemon *d) {
    if (d->stopping)
        return;
    d->stopping = true;
    if (d->net)
        net_close(d->net);
    if (d->studio.voices)
        voice_pool_close(d->studio.voices, NULL, NULL);
    for (int i = 0; d->signals_set && i < 2; i++)
        uv_close((uv_handle_t *)&d->stop_signals[i], NULL);
}

static void on_signal(uv_signal_t *handle, int number) {
    log_info("%s: stopping", strsignal(number));
    stop(handle->data);
}

static int start(struct daemon *d, const struct daemon_options *o, struct error *e) {
    static const int signals[] = {SIGTERM, SIGINT};
    char path[4096];
    snprintf(path, sizeof path, "%s/speech", d->paths.models);
    if (speech_packs_load(&d->packs, path, e))
        return -1;
    if (!speech_packs_find(&d->packs, o->lang))
        return error_in_field(e, "unknown-language", "--lang", "no language '%s'", o->lang);
    d->studio = (struct studio){.loop = &d->loop, .packs = &d->packs, .default_lang = o->lang};
    d->net = net_open(&d->studio, &o->net, e);
    if (!d->net)
        return -1;
    struct voice_pool_options voices = o->voices;
    char *config = *d->paths.voice_config ? voice_config_read(d->paths.voice_config, e) : NULL;
    if (*d->paths.voice_config && !config)
        return -1;
    voices.config = config;
    d->studio.voices = voice_pool_open(&d->loop, &voices, on_ready, d, e);
    free(config);
    if (!d->studio.voices)
        return -1;
    for (int i = 0; i < 2; i++) {
        uv_signal_init(&d->loop, &d->stop_signals[i]);
        d->stop_signals[i].data = d;
        uv_signal_start(&d->stop_signals[i], on_signal, signals[i]);
    }
    d->signals_set = true;
    return 0;
}

int main(int argc, char **argv) {
    struct daemon d = {0};
    struct daemon_options options = {.net = net_defaults, .lang = "it"};
    struct error e;
    char text[400];
    paths_find(&d.paths);
    parse(argc, argv, &options, &d.paths);
    options.net.web = d.paths.web;
    options.net.models = d.paths.models;
    options.voices.worker = d.paths.worker;
    options.voices.plugin_dir = d.paths.plugins;
    signal(SIGPIPE, SIG_IGN);
    uv_loop_init(&d.loop);
    int status = start(&d, &options, &e) ? 1 : 0;
    if (status) {
        log_error("%s", error_text(&e, text, sizeof text));
        stop(&d);
    } else {
        log_info("listening on http://%s:%d/", options.net.host, net_port(d.net));
    }
    uv_run(&d.loop, UV_RUN_DEFAULT);
    if (d.net)
        net_free(d.net);
    uv_loop_close(&d.loop);
    speech_packs_free(&d.packs);
    paths_free(&d.paths);
    return status;
}
