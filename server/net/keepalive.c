/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks after all connections once a second: those that take nothing, or do not come to an end, are closed,
 * and their protocols look after themselves. One timer for all. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/connection.h"
#include "server/net/listener.h"
#include "server/net/net_internal.h"
#include <malloc.h>
#include <stdlib.h>

enum { LOOK_MS = 1000, TRIM_BYTES = 32 << 20, TRIM_AGAIN_MS = 10000 };

/* Has it taken nothing for too long, though bytes wait? */
static bool is_stalled(struct connection *c) {
    size_t unsent = connection_unsent(c);
    if (!unsent || unsent != c->unsent)
        c->progress = connection_now(c);
    c->unsent = unsent;
    return connection_now(c) - c->progress >= (uint64_t)c->net->options.stall_seconds * 1000;
}

static void look(struct connection *c) {
    if (c->closing)
        return;
    if (c->end_by && connection_now(c) >= c->end_by) {
        connection_close(c);
    } else if (is_stalled(c)) {
        metrics_add(c->net->pipeline->metrics, METRIC_TOO_SLOW, 1);
        log_info("%s takes nothing: closed (too-slow)", c->name);
        connection_close(c);
    } else if (c->finished) {
        return;
    } else if (c->protocol->look) {
        c->protocol->look(c);
    }
}

/* What a burst of clients took goes back to the system: the C library keeps what was freed in the middle of
 * its heaps, however much. Looking for it takes milliseconds, so it is done when 32 MB are free, every ten
 * seconds at most. */
static void give_back_memory(struct net *net) {
    if (uv_now(net->pipeline->loop) < net->trim_at || mallinfo2().fordblks < TRIM_BYTES)
        return;
    malloc_trim(0);
    net->trim_at = uv_now(net->pipeline->loop) + TRIM_AGAIN_MS;
}

static void on_timer(uv_timer_t *timer) {
    struct net *net = timer->data;
    for (struct connection *c = net->open; c; c = c->next)
        look(c);
    listeners_look(net);
    hold_look(net);
    give_back_memory(net);
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
