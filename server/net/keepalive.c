/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks after all connections once a second: those that take nothing, or do not come to an end, are closed;
 * sockets that have been silent are asked whether they are still there (RFC 6455, 5.5.2), and closed when
 * they do not answer. One timer for all. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/http_session.h"
#include "server/net/listener.h"
#include "server/net/socket_internal.h"
#include <stdlib.h>

enum { LOOK_MS = 1000 };

/* Has it taken nothing for too long, though bytes wait? */
static bool is_stalled(struct connection *c) {
    size_t unsent = connection_unsent(c);
    if (!unsent || unsent != c->unsent)
        c->progress = connection_now(c);
    c->unsent = unsent;
    return connection_now(c) - c->progress >= (uint64_t)c->net->options.stall_seconds * 1000;
}

void socket_look(struct socket *s) {
    uint64_t silent = connection_now(s->connection) - s->last_rx;
    uint64_t ping_ms = (uint64_t)s->net->options.ping_seconds * 1000;
    if (s->closing)
        return;
    if (s->hang_up_by) {
        socket_heard(s); /* it says nothing more */
        bool over = !stream_busy(socket_stream(s)) && message_queue_empty(&s->queue);
        if (over || connection_now(s->connection) >= s->hang_up_by)
            socket_farewell(s, s->hangs_up, "");
        return;
    }
    if (s->rx_paused || s->reading)
        socket_heard(s); /* its answers lie unread */
    else if (s->probe == PROBE_NONE && silent >= ping_ms)
        socket_ping(s);
    else if (s->probe != PROBE_NONE && silent >= ping_ms + ping_ms / 3) {
        log_info("%s does not answer: closed", s->name);
        connection_close(s->connection);
    }
}

static void look(struct connection *c) {
    if (c->closing)
        return;
    if (c->end_by && connection_now(c) >= c->end_by) {
        connection_close(c);
    } else if (is_stalled(c)) {
        metrics_add(c->net->pipeline->metrics, METRIC_TOO_SLOW, 1);
        log_info("%s takes nothing: closed (too-slow)", c->socket ? c->socket->name : "an HTTP client");
        connection_close(c);
    } else if (c->finished) {
        return;
    } else if (c->socket) {
        socket_look(c->socket);
    } else {
        http_session_look(c);
    }
}

static void on_timer(uv_timer_t *timer) {
    struct net *net = timer->data;
    for (struct connection *c = net->open; c; c = c->next)
        look(c);
    listeners_look(net);
}

void socket_heard(struct socket *s) {
    s->last_rx = connection_now(s->connection);
    s->probe = PROBE_NONE;
}

void keepalive_begin(struct net *net) {
    net->keepalive = mem_alloc(sizeof *net->keepalive);
    uv_timer_init(net->pipeline->loop, net->keepalive);
    net->keepalive->data = net;
    uv_timer_start(net->keepalive, on_timer, LOOK_MS, LOOK_MS);
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

void keepalive_end(struct net *net) {
    if (net->keepalive)
        uv_close((uv_handle_t *)net->keepalive, free_timer);
    net->keepalive = NULL;
}
