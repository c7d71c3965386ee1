/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks after all connections once a second: those who take nothing are closed; sockets that have been silent
 * are asked whether they are still there (RFC 6455, 5.5.2), and closed when they do not answer. One timer for
 * all: libwebsockets' own, one for each connection, wait in a busy loop for the last millisecond before each.
 */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/socket_parts.h"
#include <stdlib.h>

enum { LOOK_MS = 1000 };

/* The library closes it when it is next at work. */
static void cut_off(struct net *net, struct lws *wsi) {
    lws_cancel_service(net->context);
    lws_set_timeout(wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

bool watch_stalled(struct net *net, struct lws *wsi, const char *name, uint64_t progress) {
    if (uv_now(net->studio->loop) - progress < (uint64_t)net->options.stall_seconds * 1000)
        return false;
    metrics_add(net->studio->metrics, METRIC_TOO_SLOW, 1);
    log_info("%s takes nothing: closed (too-slow)", name);
    cut_off(net, wsi);
    return true;
}

static void look(struct socket *s, uint64_t now) {
    uint64_t ping_ms = (uint64_t)s->net->options.ping_seconds * 1000;
    if (s->closing)
        return;
    if (s->deaf)
        socket_heard(s); /* his answers lie unread */
    if (!outbox_empty(&s->outbox) && watch_stalled(s->net, s->wsi, s->name, s->progress)) {
        s->closing = true;
    } else if (s->probe == PROBE_NONE && now - s->heard >= ping_ms) {
        s->probe = PROBE_DUE;
        lws_callback_on_writable(s->wsi);
    } else if (s->probe != PROBE_NONE && now - s->heard >= ping_ms + ping_ms / 3) {
        log_info("%s does not answer: closed", s->name);
        s->closing = true;
        cut_off(s->net, s->wsi);
    }
}

static void on_timer(uv_timer_t *timer) {
    struct net *net = timer->data;
    uint64_t now = uv_now(net->studio->loop);
    for (struct socket *s = net->sockets; s; s = s->next)
        look(s, now);
    exchanges_look(net);
}

void socket_heard(struct socket *s) {
    s->heard = uv_now(s->net->studio->loop);
    s->probe = PROBE_NONE;
}

int socket_ping(struct socket *s) {
    uint8_t ping[LWS_PRE + 1] = {0}; /* of an answer without a byte the library says nothing */
    s->probe = PROBE_SENT;
    if (!outbox_empty(&s->outbox))
        lws_callback_on_writable(s->wsi);
    return lws_write(s->wsi, ping + LWS_PRE, 1, LWS_WRITE_PING) < 0 ? -1 : 0;
}

void watch_begin(struct net *net) {
    net->watch = mem_alloc(sizeof *net->watch);
    uv_timer_init(net->studio->loop, net->watch);
    net->watch->data = net;
    uv_timer_start(net->watch, on_timer, LOOK_MS, LOOK_MS);
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

void watch_end(struct net *net) {
    if (net->watch)
        uv_close((uv_handle_t *)net->watch, free_timer);
    net->watch = NULL;
}
