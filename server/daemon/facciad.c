/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/page_link.h"
#include "server/access/revocations.h"
#include "server/api/api.h"
#include "server/api/offer.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/program.h"
#include "server/base/work/work_gate.h"
#include "server/cluster/cluster.h"
#include "server/codec/coder_pool.h"
#include "server/daemon/components.h"
#include "server/daemon/library_setup.h"
#include "server/daemon/service.h"
#include "server/daemon/settings.h"
#include "server/http/certificate.h"
#include "server/http/transport.h"
#include "server/library/publish/prerender.h"
#include "server/library/work_lexicons.h"
#include "server/synthesis/synthesis.h"
#include <errno.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Secrets and revoked tokens, from the settings' files. */

struct access_setup {
    struct secrets secrets; /* empty: no token is required */
    struct revocations revocations;
};

/* The daemon's TLS certificate, from the settings. */

struct tls_setup {
    struct transport_tls tls; /* owns its strings */
    bool on;
};

/* The connections to the cluster, from the settings. */

struct cluster_setup {
    struct cluster *cluster;   /* shared state; NULL: not in a cluster */
    struct bus *bus;           /* messages between nodes */
    struct presence *presence; /* notes and marks shared with other daemons */
    struct work *work;         /* sentences spoken by remote workers */
};

static void access_setup_free(struct access_setup *setup) {
    secrets_free(&setup->secrets);
    revocations_free(&setup->revocations);
}

/* -1 with *e, and nothing to free. */
static int access_setup_load(struct access_setup *setup, const struct settings *settings, struct error *e) {
    *setup = (struct access_setup){0};
    if ((!settings->secret_file || !secrets_load(&setup->secrets, settings->secret_file, e)) &&
        (!settings->revoked_file ||
         !revocations_load(&setup->revocations, settings->revoked_file, (long)time(NULL), e)))
        return 0;
    access_setup_free(setup);
    return -1;
}

static char *join(const char *folder, const char *name) {
    struct buf path = {0};
    buf_printf(&path, "%s/%s", folder, name);
    return (char *)path.data;
}

static int make_own(struct tls_setup *setup, const char *folder, struct error *e) {
    setup->tls = (struct transport_tls){join(folder, "cert.pem"), join(folder, "key.pem")};
    if (mkdir(folder, 0700) && errno != EEXIST)
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-self-signed", "cannot create '%s': %s", folder,
                              strerror(errno));
    char *ca = join(folder, "ca.pem"), fingerprint[CERTIFICATE_FINGERPRINT];
    const struct certificate_files files = {setup->tls.cert, setup->tls.key, ca};
    int failed = !certificate_good(files.cert) && certificate_make(&files, e) ? -1 : 0;
    if (!failed)
        failed = certificate_fingerprint(files.cert, fingerprint, e);
    if (!failed)
        log_info("TLS with a self-made certificate: devices that have installed %s trust it; others warn "
                 "(SHA-256 fingerprint: %s)",
                 ca, fingerprint);
    free(ca);
    return failed;
}

/* Names the files. Creates those of --tls-self-signed unless valid ones exist, and logs their fingerprint;
 * the transport checks the operator's files when it opens. -1 with *e. The caller frees it in either case. */
static int tls_setup_open(struct tls_setup *setup, const struct settings *s, struct error *e) {
    *setup = (struct tls_setup){0};
    if (!s->tls_cert != !s->tls_key)
        return error_in_field(e, ERROR_BAD_FIELD, s->tls_cert ? "--tls-cert" : "--tls-key",
                              "a certificate needs its key: --tls-cert FILE --tls-key FILE");
    if (s->tls_cert && s->tls_self_signed)
        return error_in_field(e, ERROR_BAD_FIELD, "--tls-self-signed",
                              "it cannot be combined with --tls-cert");
    if (!s->tls_cert && !s->tls_self_signed)
        return 0;
    setup->on = true;
    if (s->tls_self_signed)
        return make_own(setup, s->tls_self_signed, e);
    setup->tls = (struct transport_tls){mem_strdup(s->tls_cert), mem_strdup(s->tls_key)};
    return 0;
}

static void tls_setup_free(struct tls_setup *setup) {
    free((char *)setup->tls.cert);
    free((char *)setup->tls.key);
    *setup = (struct tls_setup){0};
}

/* All NULL: not in a cluster. -1 with *e when the setting is invalid or the daemon was built without
 * hiredis. */
static int cluster_setup_open(const struct settings *settings, uv_loop_t *loop, struct metrics *metrics,
                              struct cluster_setup *out, struct error *e) {
    *out = (struct cluster_setup){0};
    if (!settings->cluster || !*settings->cluster)
        return 0;
    const struct cluster_options options = {settings->cluster, settings->cluster_keep_hours, metrics};
    const struct work_options queue = {settings->cluster, settings->cluster_queue, metrics};
    if (!(out->cluster = cluster_open(loop, &options, e)) ||
        !(out->bus = bus_open(loop, settings->cluster, metrics, e)) ||
        !(out->presence = presence_open(loop, settings->cluster, metrics, e)) ||
        !(out->work = work_open(loop, &queue, e)))
        return -1;
    return 0;
}

/* They are closed when the loop has finished. */
static void cluster_setup_close(struct cluster_setup *setup) {
    cluster_close(setup->cluster);
    bus_close(setup->bus);
    presence_close(setup->presence);
    work_close(setup->work);
    *setup = (struct cluster_setup){0};
}

#ifdef HAVE_LIBRARY
/* Starts to prerender the library once there are voices, if the settings ask for it and it has not
 * started. */
static void start_prerender(struct prerender **prerender, const struct settings *s,
                            const struct pipeline *pipeline, struct library *library) {
    const struct cache_options *cache = &s->voices.cache;
    uint64_t kept = cache->file && *cache->file ? cache->file_bytes : cache->bytes;
    uint64_t most = s->ahead_bytes ? s->ahead_bytes : kept / 4 * 3;
    struct error e;
    if (*prerender || !s->ahead || !library)
        return;
    if (!kept)
        log_warn("prerendering is off: there is no sentence cache (--cache, --cache-file)");
    else if (voice_pool_settled(pipeline->voices, s->ahead, NULL) &&
             !voice_pool_find(pipeline->voices, s->ahead, NULL, NULL, &e))
        log_warn("prerendering is off: --library-ahead: %s", e.message);
    else
        *prerender =
            prerender_open(pipeline, library, s->ahead, most < kept ? most : kept, s->api.text_bytes);
}

#else
static void start_prerender(struct prerender **prerender, const struct settings *s,
                            const struct pipeline *pipeline, struct library *library) {
    (void)prerender, (void)s, (void)pipeline, (void)library;
}

int library_setup_open(const struct settings *s, const struct paths *paths, struct library **library,
                       char **voice_config, struct error *e) {
    (void)paths, (void)library, (void)voice_config;
    return s->library
               ? error_in_field(e, ERROR_BAD_FIELD, "--library", "this daemon was built without the library")
               : 0;
}

void library_close(struct library *library) {
    (void)library;
}

void prerender_close(struct prerender *prerender) {
    (void)prerender;
}
#endif

enum {
    OWN = 48,        /* for the loop, files being read, and listening sockets */
    EACH_WORKER = 4, /* for its socket and its start */
    PLUGINS = 6,
    LEAST = 4 /* connections */
};

/* Raises the descriptor limit to what connections, workers and the daemon itself need. If it cannot,
 * reduces the number of connections, and logs that. */
static void provide_descriptors(struct http_options *o, unsigned workers) {
    struct rlimit limit;
    rlim_t own = OWN + (rlim_t)EACH_WORKER * PLUGINS * workers;
    rlim_t need = own + o->connections + o->connections_above;
    if (getrlimit(RLIMIT_NOFILE, &limit) || limit.rlim_cur >= need)
        return;
    limit.rlim_cur = limit.rlim_max < need ? limit.rlim_max : need;
    if (setrlimit(RLIMIT_NOFILE, &limit))
        getrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_cur >= need)
        return;
    /* an eighth of the rest serves to turn connections away with a message */
    rlim_t left = limit.rlim_cur > own + LEAST ? limit.rlim_cur - own : LEAST;
    unsigned above = (unsigned)(left / 8 + 1), asked = o->connections;
    if (above < o->connections_above)
        o->connections_above = above;
    o->connections = (unsigned)left - o->connections_above;
    log_warn("%llu file descriptors are too few for %u connections: the limit is now %u (see ulimit -n, "
             "LimitNOFILE=)",
             (unsigned long long)limit.rlim_cur, asked, o->connections);
}

/* Prints what needs no start: help, version, settings. Returns the exit status, or -1 to continue. */
static int print_request(const struct settings *settings, const struct settings_request *request) {
    struct buf text = {0};
    if (request->help) {
        buf_printf(&text, "Usage: facciad [OPTION]...\nServes the talking head: web pages, a WebSocket and "
                          "an HTTP API (see protocol/README.md).\n\n");
        settings_help(PROGRAM_DAEMON, &text);
    } else if (request->version)
        buf_printf(&text, "facciad " FACCIA_VERSION "\n");
    else if (request->schema)
        settings_schema(&text);
    else if (request->print)
        settings_print(settings, &text);
    else
        return -1;
    fwrite(text.data, 1, text.size, stdout);
    buf_free(&text);
    return 0;
}

/* Describes the components' offer for the network. */
struct daemon_offer {
    struct offer offer;
    const struct pipeline *pipeline;
    struct offer_language *languages;
    const char **engines; /* lists of all languages, each NULL-terminated */
    struct offer_expression *expressions;
    const struct expressions *expressions_of; /* a reference to the described ones */
    struct offer_voice *voices;
    const struct voice *voices_of; /* the pool's list that is described */
};

static void describe_languages(struct daemon_offer *o) {
    const struct speech_packs *packs = o->pipeline->packs;
    size_t engines = 0;
    while (face_engines()[engines])
        engines++;
    o->languages = mem_alloc((packs->count + 1) * sizeof *o->languages);
    o->engines = mem_alloc((packs->count + 1) * (engines + 1) * sizeof *o->engines);
    const char **list = o->engines;
    for (size_t i = 0; i < packs->count; i++) {
        const struct speech_pack *pack = packs->packs[i];
        if (speech_pack_is_general(pack))
            continue;
        o->languages[o->offer.language_count++] =
            (struct offer_language){speech_pack_lang(pack), speech_pack_name(pack), list};
        for (size_t k = 0; k < engines; k++)
            if (face_engine_speaks(face_engines()[k], pack))
                *list++ = face_engines()[k];
        *list++ = NULL;
    }
    o->offer.languages = o->languages;
}

static void describe_expressions(struct daemon_offer *o) {
    const struct expressions *expressions = o->pipeline->expressions;
    size_t count = expressions_count(expressions);
    if (expressions == o->expressions_of)
        return;
    free(o->expressions);
    expressions_free(o->expressions_of);
    o->expressions_of = expressions_share(expressions);
    o->expressions = mem_alloc((count + 1) * sizeof *o->expressions);
    for (size_t i = 0; i < count; i++) {
        struct expression_info info = expressions_info(expressions, i);
        o->expressions[i] =
            (struct offer_expression){info.kind, info.name, info.activation, info.evaluation, info.basic};
    }
    o->offer.expressions = o->expressions;
    o->offer.expression_count = count;
}

static void describe_voices(struct daemon_offer *o) {
    size_t count = 0;
    const struct voice *v = o->pipeline->voices ? voice_pool_voices(o->pipeline->voices, &count) : NULL;
    if (v == o->voices_of && count == o->offer.voice_count)
        return;
    /* allocated before the old list is freed, so that its address differs and the change is noticed */
    struct offer_voice *voices = mem_alloc((count + 1) * sizeof *voices);
    for (size_t i = 0; i < count; i++) {
        const struct speech_pack *pack = speech_packs_find(o->pipeline->packs, v[i].lang);
        voices[i] = (struct offer_voice){.id = v[i].id,
                                         .name = v[i].name,
                                         .lang = v[i].lang,
                                         .gender = v[i].gender,
                                         .quality = v[i].quality,
                                         .licence = v[i].licence,
                                         .plugin = v[i].plugin,
                                         .sample_rate = v[i].sample_rate,
                                         .words_per_minute = v[i].rate,
                                         .shares = pack && speech_pack_is_general(pack)};
    }
    free(o->voices);
    o->voices = voices;
    o->voices_of = v;
    o->offer.voices = voices;
    o->offer.voice_count = count;
}

static const struct offer *now(void *ctx) {
    struct daemon_offer *o = ctx;
    describe_voices(o);
    describe_expressions(o);
    return &o->offer;
}

/* Borrows the pipeline, whose voices may come later and whose expressions may be replaced. */
static struct daemon_offer *daemon_offer_new(const struct pipeline *pipeline) {
    struct daemon_offer *o = mem_alloc(sizeof *o);
    o->pipeline = pipeline;
    o->offer.default_lang = pipeline->default_lang;
    o->offer.engines = face_engines();
    describe_languages(o);
    return o;
}

static void daemon_offer_free(struct daemon_offer *o) {
    if (!o)
        return;
    free(o->languages);
    free(o->engines);
    free(o->expressions);
    expressions_free(o->expressions_of);
    free(o->voices);
    free(o);
}

static struct offer_source daemon_offer_source(struct daemon_offer *offer) {
    return (struct offer_source){now, offer};
}

/* facciad: the daemon. Runs the components on one loop, reloads its settings on SIGHUP, and stops cleanly
 * on SIGTERM and SIGINT. */

enum {
    SIGNALS = 3,
    GOODBYE_MS = 200,
    LOOK_MS = 50,
    LONG_TEXT_BYTES = 16 << 10, /* takes about half a millisecond to parse */
};

struct daemon {
    uv_loop_t loop;
    int argc;
    char **argv;
    struct paths paths;
    struct settings settings;
    struct access_setup access;
    struct tls_setup tls;
    int *sockets; /* from systemd */
    unsigned socket_count;
    struct components components;
    struct reader reader; /* parses untrusted input in another process */
    struct work_gate gate;
    struct metrics metrics;
    struct coder_pool *coders;
    struct codec_load codec_load;
    struct library *library; /* NULL = none */
    char *voice_config;      /* including the library's recordings; NULL: none */
    struct cluster_setup cluster;
    struct prerender *prerender;
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
    if (components_load_expressions(&d->components, &d->settings, &e))
        complain(&e);
}

/* Fills in the members of the network's settings that are not settings of the daemon. */
static struct api_options api_options_of(struct daemon *d) {
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
    options.shares = d->cluster.cluster != NULL;
    options.hears = d->components.pipeline.ears && d->components.ears.recogniser.how;
    options.bus = d->cluster.bus;
    options.presence = d->cluster.presence;
    options.http.connections_above = API_CONNECTIONS_ABOVE;
    provide_descriptors(&options.http, d->settings.voices.workers);
    return options;
}

static void stop(struct daemon *d);

static void on_ready(void *ctx) {
    struct daemon *d = ctx;
    char status[80];
    size_t count;
    voice_pool_voices(d->components.pipeline.voices, &count);
    if (!count) {
        static const char none[] = "no voice plugin could be started";
        log_error(none);
        api_set_unavailable(d->api, none);
        return;
    }
    if (!synthesis_can_speak(&d->components.pipeline, d->settings.lang)) {
        struct error e;
        error_in_field(&e, ERROR_UNKNOWN_LANGUAGE, "--lang", "unknown language '%s'", d->settings.lang);
        complain(&e);
        d->failed = true;
        stop(d);
        return;
    }
    api_set_ready(d->api);
    start_prerender(&d->prerender, &d->settings, &d->components.pipeline, d->library);
    snprintf(status, sizeof status, "%zu voices, %zu language packs", count, d->components.packs.count);
    log_info("ready: %s", status);
    service_ready(status);
}

/* Applies the settings that need no restart. */
static void reload(struct daemon *d) {
    struct settings settings;
    struct settings_request request;
    struct access_setup access = {0};
    struct error e;
    service_reloading();
    if (settings_read(&settings, &request, PROGRAM_DAEMON, d->argc, d->argv, &d->paths, &e) ||
        access_setup_load(&access, &settings, &e)) {
        complain(&e);
        log_warn("keeping the current settings");
        settings_free(&settings);
    } else if (d->access.secrets.count && !access.secrets.count) {
        log_warn("tokens cannot be turned off while the daemon runs; keeping the current settings");
        settings_free(&settings);
        access_setup_free(&access);
    } else {
        struct settings old = d->settings;
        struct access_setup old_access = d->access;
        d->settings = settings;
        d->access = access;
        struct api_options options = api_options_of(d);
        api_change(d->api, &options);
        d->components.live.most = settings.live_voices;
        d->components.live.key_most = settings.live_voices_per_address;
        d->components.live.seconds = settings.live_voice_seconds;
        d->components.ears.most = settings.live_voices;
        d->components.ears.key_most = settings.live_voices_per_address;
        d->components.ears.seconds = d->components.ears.recogniser.seconds = settings.hear_seconds;
        log_open(settings_log_format(&d->settings));
        if (settings_need_restart(&old, &settings))
            log_warn(
                "changes of listen, speech, voices, library, paths or cluster take effect after a restart");
        log_info("settings reloaded");
        settings_follow(&d->settings, &old);
        access_setup_free(&old_access);
    }
    service_ready("running");
}

static void stop(struct daemon *d) {
    if (d->stopped)
        return;
    d->stopped = true;
    if (d->api)
        api_close(d->api);
    prerender_close(d->prerender);
    components_stop_voices(&d->components);
    cluster_setup_close(&d->cluster);
    coder_pool_close(d->coders);
    if (!d->running)
        return;
    for (int i = 0; i < SIGNALS; i++)
        uv_close((uv_handle_t *)&d->signals[i], NULL);
    uv_close((uv_handle_t *)&d->ending, NULL);
    service_watchdog_stop(&d->watchdog);
}

/* Lets speech finish within the limit, then says goodbye to the clients, and stops a moment later. */
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

/* Loads files first, then opens the network, so that voices start only when it works. */
static int start(struct daemon *d, struct error *e) {
    const struct settings *s = &d->settings;
    struct voice_pool_options voices = s->voices;
    struct pipeline *pipeline = &d->components.pipeline;
    if (access_setup_load(&d->access, s, e) || tls_setup_open(&d->tls, s, e) ||
        components_load(&d->components, s, COMPONENTS_ALL, &d->loop, e))
        return -1;
    if (!speech_packs_find(&d->components.packs, s->lang))
        return error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "--lang", "unknown language '%s'", s->lang);
    if (library_setup_open(s, &d->paths, &d->library, &d->voice_config, e) ||
        cluster_setup_open(s, &d->loop, &d->metrics, &d->cluster, e))
        return -1;
    voices.cluster = d->cluster.cluster;
    voices.work = d->cluster.work;
    if (d->voice_config)
        voices.config = d->voice_config;
    pipeline->metrics = voices.metrics = &d->metrics;
    pipeline->codec_load = &d->codec_load;
    pipeline->long_text = LONG_TEXT_BYTES;
    d->reader = (struct reader){d->paths.reader, s->voices.unconfined};
    pipeline->reader = &d->reader;
    d->components.ears.recogniser.program = d->paths.recogniser;
    pipeline->gate = &d->gate;
    pipeline->open_seconds = s->api.open_seconds;
    pipeline->library = d->library;
#ifdef HAVE_LIBRARY
    pipeline->passage_lexicons = d->library ? library_lexicons : NULL;
#endif
    struct api_options options = api_options_of(d);
    d->offer = daemon_offer_new(pipeline);
    const struct offer_source offer = daemon_offer_source(d->offer);
    d->api = api_open(pipeline, &offer, &options, e);
    if (!d->api)
        return -1;
    pipeline->coders = d->coders = coder_pool_open(&d->loop, 0);
    codec_load_open(&d->codec_load, &d->loop, d->coders, &d->metrics);
    if (components_start_voices(&d->components, &voices, on_ready, d, e))
        return -1;
    watch(d);
    return 0;
}

/* Logs where the daemon listens and where other machines find it, with a QR code of the first of these
 * addresses if a person watches. */
static void log_addresses(const struct daemon *d) {
    struct buf text = {0};
    for (size_t i = 0; api_address(d->api, i, &text); i++) {
        log_info("listening on %.*s", (int)text.size, (const char *)text.data);
        buf_free(&text);
    }
    bool person = isatty(STDERR_FILENO) && !strcmp(log_format_name(), "text");
    for (size_t i = 0; api_outside_address(d->api, i, &text); i++) {
        log_info("on other machines: %.*s", (int)text.size, (const char *)text.data);
        if (!i && person)
            page_link_draw((const char *)text.data, stderr);
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
    components_free(&d->components);
    access_setup_free(&d->access);
    tls_setup_free(&d->tls);
    return status;
}

/* Makes the C library give freed memory back. Once a block of many megabytes has been freed, it by default
 * keeps up to 64 MB at the end of each thread's heap, where malloc_trim does not reach. Fixed limits prevent
 * that. */
static void limit_kept_memory(void) {
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
    mallopt(M_TRIM_THRESHOLD, 2 << 20);
}

int main(int argc, char **argv) {
    struct daemon d = {.argc = argc, .argv = argv};
    struct settings_request request;
    struct error e;
    char text[512];
    int status;
    program_begin();
    limit_kept_memory();
    paths_find(&d.paths);
    if (settings_read(&d.settings, &request, PROGRAM_DAEMON, argc, argv, &d.paths, &e)) {
        fprintf(stderr, "facciad: %s (%s)\n", error_text(&e, text, sizeof text), error_name(e.code));
        status = 2;
    } else if ((status = print_request(&d.settings, &request)) < 0) {
        log_open(settings_log_format(&d.settings));
        d.socket_count = service_sockets(&d.sockets);
        status = run(&d);
    }
    settings_free(&d.settings);
    paths_free(&d.paths);
    free(d.sockets);
    return status;
}
