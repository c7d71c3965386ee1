/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/connection.h"
#include "server/net/http_session.h"
#include "server/net/listen_address.h"
#include "server/net/listener_internal.h"
#include "server/net/net_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    ACCEPTS = 64,       /* at a time */
    BORROWED_MS = 1000, /* for which each of them is lent */
    CROWD = 8,          /* connections above what an address may have, which can be told so */
};

static void on_connection(uv_poll_t *poll, int status, int events);

static void pause_all(struct listeners *all, bool paused) {
    if (all->paused == paused)
        return;
    all->paused = paused;
    for (size_t i = 0; i < all->count; i++)
        if (paused)
            uv_poll_stop(&all->list[i]->poll);
        else
            uv_poll_start(&all->list[i]->poll, UV_READABLE, on_connection);
}

static void fill_reserve(struct listeners *all) {
    while (all->reserved < RESERVE) {
        int fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
        if (fd < 0)
            return;
        all->reserve[all->reserved++] = fd;
    }
}

/* A connection that asks for nothing at the moment gives way. */
static bool make_room(struct net *net) {
    struct connection *oldest = NULL;
    for (struct connection *c = net->open; c; c = c->next)
        if (c->http && !c->closing && http_session_is_idle(c))
            oldest = c;
    if (oldest)
        connection_close(oldest);
    return oldest != NULL;
}

/* Far above the limits: nothing is made for it, so that its descriptor is free at once. */
static bool turned_away(struct net *net, int fd, bool borrowed) {
    if (net->connections < net->options.connections + net->options.connections_above)
        return false;
    metrics_add(net->pipeline->metrics, METRIC_REFUSED_LIMIT, 1);
    close(fd);
    net->descriptor_freed(net, borrowed);
    return true;
}

static void take(struct net *net, int fd, const struct sockaddr_storage *peer, bool borrowed) {
    if (turned_away(net, fd, borrowed))
        return;
    struct connection *c = connection_open(net, fd, peer);
    http_session_open(c);
    const struct net_options *o = &net->options;
    unsigned here = quota_open(&net->quota, c->key);
    c->crowded = o->address_connections && here > o->address_connections;
    c->surplus = borrowed || (net->connections > o->connections && !make_room(net));
    c->borrows_reserve = borrowed;
    if (borrowed)
        c->end_by = connection_now(c) + BORROWED_MS;
    if (c->crowded && here > o->address_connections + CROWD) {
        metrics_add(net->pipeline->metrics, METRIC_REFUSED_LIMIT, 1);
        connection_close(c);
    }
}

static void complain(struct listeners *all, int why) {
    uint64_t now = uv_now(all->net->pipeline->loop);
    if (all->complained && now - all->complained < 1000)
        return;
    all->complained = now;
    log_warn("no connection can be taken: %s; %u are open", strerror(why), all->net->connections);
}

static int accept_from(const struct listener *l, struct sockaddr_storage *peer) {
    socklen_t size = sizeof *peer;
    *peer = (struct sockaddr_storage){0};
    int fd = accept4(l->fd, (struct sockaddr *)peer, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd >= 0 && size <= sizeof(sa_family_t))
        peer->ss_family = AF_UNIX; /* without a name */
    return fd;
}

/* There are no descriptors: those in reserve let a few in, who are told so; then nobody is let in until one
 * is free. */
static void when_full(struct listener *l, int why) {
    struct listeners *all = l->all;
    struct sockaddr_storage peer;
    complain(all, why);
    if (all->reserved) {
        close(all->reserve[--all->reserved]);
        int fd = accept_from(l, &peer);
        if (fd >= 0)
            take(all->net, fd, &peer, true);
        else
            fill_reserve(all);
    }
    if (!all->reserved)
        pause_all(all, true);
}

static void on_connection(uv_poll_t *poll, int status, int events) {
    struct listener *l = poll->data;
    struct sockaddr_storage peer;
    (void)events;
    for (int i = 0; i < ACCEPTS && !status && !l->all->paused; i++) {
        int fd = accept_from(l, &peer);
        if (fd >= 0)
            take(l->all->net, fd, &peer, false);
        else if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS)
            when_full(l, errno);
        else if (errno == EAGAIN)
            return;
    }
}

/* A connection is gone: a descriptor, perhaps one of the reserve, is free. */
static void listeners_freed(struct net *net, bool reserve) {
    struct listeners *all = net->listeners;
    if (!all || (!reserve && !all->paused && all->reserved == RESERVE))
        return;
    fill_reserve(all);
    if (all->reserved)
        pause_all(all, false);
}

void listeners_look(struct net *net) {
    listeners_freed(net, true);
}

static bool are_local(const struct listeners *all) {
    bool local = true;
    for (size_t i = 0; local && i < all->count; i++)
        local = listen_address_is_local(&all->list[i]->at);
    return local;
}

int listeners_open(struct net *net, struct error *e) {
    struct listeners *all = mem_alloc(sizeof *all);
    all->net = net;
    if (listener_sockets_open(all, e)) {
        free(all->list);
        free(all);
        return -1;
    }
    for (size_t i = 0; i < all->count; i++) {
        uv_poll_init(net->pipeline->loop, &all->list[i]->poll, all->list[i]->fd);
        all->list[i]->poll.data = all->list[i];
    }
    fill_reserve(all);
    all->paused = true;
    pause_all(all, false);
    net->listeners = all;
    net->local = are_local(all);
    net->descriptor_freed = listeners_freed;
    return 0;
}

static void on_closed(uv_handle_t *handle) {
    struct listener *l = handle->data;
    close(l->fd);
    free(l);
}

void listeners_close(struct net *net) {
    struct listeners *all = net->listeners;
    if (!all)
        return;
    net->listeners = NULL;
    for (size_t i = 0; i < all->count; i++)
        uv_close((uv_handle_t *)&all->list[i]->poll, on_closed);
    while (all->reserved)
        close(all->reserve[--all->reserved]);
    free(all->list);
    free(all);
}

bool listeners_address(const struct net *net, size_t number, struct buf *out) {
    if (!net->listeners || number >= net->listeners->count)
        return false;
    listen_address_write(&net->listeners->list[number]->at, net->options.tls != NULL, out);
    return true;
}
