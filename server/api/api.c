/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts, changes and stops the API. */
#include "server/api/api.h"
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/api/shared_limits.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/film/film_jobs.h"
#include <malloc.h>
#include <stdlib.h>

enum { TRIM_BYTES = 32 << 20, TRIM_AGAIN_MS = 10000 };

struct api *exchange_api(const struct exchange *x) {
    return exchange_owner(x);
}

static void on_serve(void *ctx, struct exchange *x) {
    (void)ctx;
    routes_serve(x);
}

static void on_upgrade(void *ctx, struct exchange *x) {
    (void)ctx;
    client_accept(x);
}

static bool on_origin(void *ctx, const struct http_request *request) {
    return principal_origin_allowed(ctx, request);
}

/* Returns memory to the system after a burst of clients: the C library otherwise keeps whatever was freed
 * in the middle of its heaps. malloc_trim takes milliseconds, so it runs only with 32 MB free and at most
 * every ten seconds. */
static void give_back_memory(struct api *api) {
    if (uv_now(api->pipeline->loop) < api->trim_at || mallinfo2().fordblks < TRIM_BYTES)
        return;
    malloc_trim(0);
    api->trim_at = uv_now(api->pipeline->loop) + TRIM_AGAIN_MS;
}

static void on_tick(void *ctx) {
    struct api *api = ctx;
    rooms_tick(api->rooms);
    give_back_memory(api);
}

/* Sets the options that are derived from others. */
static void complete(struct api_options *o) {
    o->http.tokens = o->secrets != NULL;
    o->rooms.send_bytes = o->http.send_bytes;
}

struct api *api_open(const struct pipeline *pipeline, const struct offer_source *offer,
                     const struct api_options *options, struct error *e) {
    static const struct http_calls calls = {on_serve, on_upgrade, on_origin, on_tick};
    struct api *api = mem_alloc(sizeof *api);
    api->options = *options;
    api->pipeline = pipeline;
    api->offer = *offer;
    complete(&api->options);
    const struct film_jobs_options films = {.program = options->film_program,
                                            .models = options->models,
                                            .web = options->web,
                                            .most = options->films,
                                            .most_of_client = options->films_of_client,
                                            .seconds = options->film_seconds};
    api->films = film_jobs_new(pipeline, &films);
    api->rooms = rooms_open(pipeline, &api->options.rooms, commands_run_packed, api);
    rooms_record(api->rooms, api->options.sessions);
    if (!heads_load(&api->heads, options->web, options->models, e))
        api->http = http_server_open(pipeline->loop, pipeline->metrics, &api->quota, &api->options.http,
                                     &calls, api, e);
    if (!api->http) {
        api_close(api);
        uv_run(pipeline->loop, UV_RUN_DEFAULT); /* until the handles are closed */
        api_free(api);
        return NULL;
    }
    api->secrets = secrets_good(options->secrets, &api->revoked);
    if (options->presence)
        api->shared_limits = shared_limits_open(api, rights_renew);
    rights_revoke_all(api, options->revocations);
    if (options->bus)
        rooms_share(api->rooms, options->bus);
    return api;
}

void api_change(struct api *api, const struct api_options *options) {
    struct api_options *o = &api->options;
    struct error e;
    char text[512];
    o->origins = options->origins;
    o->host_names = options->host_names;
    o->embed = options->embed;
    o->editing = options->editing;
    o->text_bytes = options->text_bytes;
    o->play_bytes = options->play_bytes;
    o->open = options->open;
    o->open_seconds = options->open_seconds;
    o->address_requests = options->address_requests;
    o->lag_seconds = options->lag_seconds;
    o->http = options->http;
    o->rooms = options->rooms;
    complete(o);
    rooms_change(api->rooms, &o->rooms);
    if (http_server_change(api->http, &o->http, &e))
        log_error("%s; keeping the current certificate", error_text(&e, text, sizeof text));
    rights_revoke_all(api, options->revocations);
    rights_replace(api, options->secrets);
    shared_limits_change(api->shared_limits);
}

void api_drain(struct api *api) {
    api->draining = true;
    http_server_drain(api->http);
}

bool api_busy(const struct api *api) {
    return http_server_pending(api->http) || clients_busy(api);
}

void api_dismiss(struct api *api, const char *reason) {
    rooms_unshare(api->rooms);
    clients_dismiss(api, reason);
}

bool api_address(const struct api *api, size_t number, struct buf *out) {
    return http_server_address(api->http, number, out);
}

bool api_outside_address(const struct api *api, size_t number, struct buf *out) {
    return http_server_outside_address(api->http, number, out);
}

void api_set_ready(struct api *api) {
    api->ready = true;
    api->unavailable = NULL;
}

void api_set_unavailable(struct api *api, const char *reason) {
    api->unavailable = reason;
}

void api_close(struct api *api) {
    rooms_unshare(api->rooms);
    shared_limits_close(api->shared_limits);
    http_server_close(api->http);
    search_queue_close(&api->searches);
    search_queue_close(&api->saves);
    search_queue_close(&api->reads);
    search_queue_close(&api->coaches);
    rooms_close(api->rooms);
    film_jobs_close(api->films);
}

void api_free(struct api *api) {
    http_server_free(api->http);
    rooms_free(api->rooms);
    film_jobs_free(api->films);
    heads_free(&api->heads);
    quota_free(&api->quota);
    secrets_free(&api->secrets);
    free(api->revoked.marks);
    revocations_free(&api->revocations);
    json_decref(api->more_languages);
    free(api);
}
