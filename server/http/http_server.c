/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/http_server.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include <stdlib.h>

enum { LOOK_MS = 1000 };

/* Returns whether the client has taken no bytes for too long while some wait. */
static bool is_stalled(struct connection *c) {
    size_t unsent = connection_unsent(c);
    if (!unsent || unsent != c->unsent)
        c->progress = connection_now(c);
    c->unsent = unsent;
    return connection_now(c) - c->progress >= (uint64_t)c->server->options.stall_seconds * 1000;
}

static void look(struct connection *c) {
    if (c->closing)
        return;
    if (c->end_by && connection_now(c) >= c->end_by) {
        connection_close(c);
    } else if (is_stalled(c)) {
        metrics_add(c->server->metrics, METRIC_TOO_SLOW, 1);
        log_info("%s takes nothing: closed (too-slow)", c->name);
        connection_close(c);
    } else if (c->finished) {
        return;
    } else if (c->protocol->look) {
        c->protocol->look(c);
    }
}

/* One timer for all connections. */
static void on_timer(uv_timer_t *timer) {
    struct http_server *server = timer->data;
    for (struct connection *c = server->open; c; c = c->next)
        look(c);
    listeners_freed(server, true);
    server->calls->tick(server->ctx);
}

static void open_handles(struct http_server *server) {
    server->idle = mem_alloc(sizeof *server->idle);
    uv_idle_init(server->loop, server->idle);
    server->idle->data = server;
    server->timer = mem_alloc(sizeof *server->timer);
    uv_timer_init(server->loop, server->timer);
    server->timer->data = server;
    uv_timer_start(server->timer, on_timer, LOOK_MS, LOOK_MS);
}

struct http_server *http_server_open(uv_loop_t *loop, struct metrics *metrics, struct quota *quota,
                                     const struct http_options *options, const struct http_calls *calls,
                                     void *ctx, struct error *e) {
    struct http_server *server = mem_alloc(sizeof *server);
    *server = (struct http_server){
        .options = *options, .calls = calls, .ctx = ctx, .loop = loop, .metrics = metrics, .quota = quota};
    server->transport = transport_open(loop, &connection_calls, options->tls, e);
    if (!server->transport || listeners_open(server, e)) {
        http_server_close(server);
        uv_run(loop, UV_RUN_DEFAULT); /* until the handles are closed */
        http_server_free(server);
        return NULL;
    }
    open_handles(server);
    return server;
}

int http_server_change(struct http_server *server, const struct http_options *options, struct error *e) {
    struct http_options *o = &server->options;
    o->connections = options->connections;
    o->connections_above = options->connections_above;
    o->address_connections = options->address_connections;
    o->message_bytes = options->message_bytes;
    o->send_bytes = options->send_bytes;
    o->send_bytes_max = options->send_bytes_max;
    o->stall_seconds = options->stall_seconds;
    o->ping_seconds = options->ping_seconds;
    return o->tls ? transport_renew_tls(server->transport, o->tls, e) : 0;
}

void http_server_drain(struct http_server *server) {
    server->draining = true;
}

static void free_handle(uv_handle_t *handle) {
    free(handle);
}

void http_server_close(struct http_server *server) {
    if (!server)
        return;
    listeners_close(server);
    if (server->timer)
        uv_close((uv_handle_t *)server->timer, free_handle);
    connections_close(server);
    if (server->transport)
        transport_close(server->transport);
    if (server->idle)
        uv_close((uv_handle_t *)server->idle, free_handle);
    server->timer = NULL;
    server->idle = NULL;
}

void http_server_free(struct http_server *server) {
    if (!server)
        return;
    if (server->transport)
        transport_free(server->transport);
    free(server);
}

bool http_server_address(const struct http_server *server, size_t number, struct buf *out) {
    return listeners_address(server, number, out);
}

bool http_server_outside_address(const struct http_server *server, size_t number, struct buf *out) {
    return listeners_outside_address(server, number, out);
}

bool http_server_is_local(const struct http_server *server) {
    return server->local;
}

unsigned http_server_connections(const struct http_server *server) {
    return server->connections;
}

unsigned http_server_pending(const struct http_server *server) {
    return server->pending;
}
