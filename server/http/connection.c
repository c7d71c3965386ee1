/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/quota.h"
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FINISH_MS = 2000,    /* wait for the peer to close */
    UNSENT_BYTES = 16384 /* in the kernel's send buffer */
};

uint64_t connection_now(const struct connection *c) {
    return uv_now(c->server->loop);
}

/* Returns the quota key of an address. IPv6 addresses are counted by their /64, because one client may
 * have a whole network. */
static char *key_of(const struct sockaddr_storage *peer) {
    char text[INET6_ADDRSTRLEN] = "local", key[80];
    const struct sockaddr_in6 *six = (const struct sockaddr_in6 *)peer;
    const char *rest = "";
    if (peer->ss_family == AF_INET) {
        inet_ntop(AF_INET, &((const struct sockaddr_in *)peer)->sin_addr, text, sizeof text);
    } else if (peer->ss_family == AF_INET6 && IN6_IS_ADDR_V4MAPPED(&six->sin6_addr)) {
        inet_ntop(AF_INET, six->sin6_addr.s6_addr + 12, text, sizeof text);
    } else if (peer->ss_family == AF_INET6) {
        struct in6_addr network = {0};
        memcpy(&network, &six->sin6_addr, 8);
        inet_ntop(AF_INET6, &network, text, sizeof text);
        rest = "/64";
    }
    snprintf(key, sizeof key, "a %s%s", text, rest);
    return mem_strdup(key);
}

static void on_read(void *owner, const char *bytes, size_t size) {
    struct connection *c = owner;
    if (!c->finished && !c->closing)
        c->protocol->read(c, bytes, size);
}

static void on_eof(void *owner) {
    struct connection *c = owner;
    if (c->finished || !c->protocol->eof)
        connection_close(c);
    else if (!c->closing)
        c->protocol->eof(c);
}

void connection_read(struct connection *c, bool on) {
    if (c->closing || c->paused == !on)
        return;
    c->paused = !on;
    peer_read(c->peer, on);
}

static void count(struct http_server *server, int change) {
    server->connections += (unsigned)change;
    metrics_add(server->metrics, METRIC_CONNECTIONS, change);
    if (change > 0)
        metrics_add(server->metrics, METRIC_CONNECTIONS_TOTAL, 1);
}

/* Keeps unsent data in our queues, where media can be dropped, and out of the kernel, which would buffer
 * minutes of it. The socket is writable only while less than this is unsent (tcp(7)). */
static void prepare(int fd) {
    int bytes = UNSENT_BYTES, yes = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &bytes, sizeof bytes);
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

struct connection *connection_open(struct http_server *server, int fd, const struct sockaddr_storage *peer) {
    struct connection *c = mem_alloc(sizeof *c);
    *c = (struct connection){
        .server = server, .next = server->open, .self = &server->open, .address_key = key_of(peer)};
    c->number = ++server->numbered ? server->numbered : ++server->numbered;
    c->key = mem_strdup(c->address_key);
    c->local = listen_address_is_local(peer);
    quota_enter(server->quota, c->key, 0);
    if (c->next)
        c->next->self = &c->next;
    server->open = c;
    count(server, 1);
    if (peer->ss_family != AF_UNIX)
        prepare(fd);
    c->peer = peer_open(server->transport, fd, c);
    return c;
}

void connection_use(struct connection *c, const struct connection_protocol *protocol) {
    c->protocol = protocol;
    connection_read(c, true);
}

bool connection_count(struct connection *c, const char *key) {
    if (!strcmp(key, c->key))
        return true;
    if (!quota_enter(c->server->quota, key, c->server->options.address_connections))
        return false;
    quota_leave(c->server->quota, c->key);
    free(c->key);
    c->key = mem_strdup(key);
    return true;
}

static void on_sent(void *owner) {
    struct connection *c = owner;
    c->progress = connection_now(c);
    if (!c->closing && !c->finished)
        c->protocol->sent(c);
}

size_t connection_send_parts(struct connection *c, const struct iovec *parts, size_t count) {
    if (!peer_unsent(c->peer))
        c->progress = connection_now(c);
    return peer_write(c->peer, parts, count);
}

size_t connection_send(struct connection *c, const void *bytes, size_t size) {
    /* iovec is not const, but sendmsg does not change the bytes */
    const struct iovec part = {(void *)(uintptr_t)bytes, size};
    return connection_send_parts(c, &part, 1);
}

size_t connection_unsent(const struct connection *c) {
    return c->closing ? 0 : peer_unsent(c->peer);
}

bool connection_secure(const struct connection *c) {
    return peer_secure(c->peer);
}

void connection_finish(struct connection *c) {
    if (c->finished || c->closing)
        return;
    c->finished = true;
    c->end_by = connection_now(c) + FINISH_MS;
    peer_finish(c->peer);
    connection_read(c, true);
}

/* Frees the protocol's state. */
static void drop_protocol(struct connection *c) {
    if (c->protocol)
        c->protocol->free(c);
    c->protocol = NULL;
}

static void forget_due(struct connection *c) {
    struct connection **at = &c->server->due;
    while (*at && *at != c)
        at = &(*at)->next_due;
    if (*at)
        *at = c->next_due;
}

static void on_closed(void *owner) {
    struct connection *c = owner;
    struct http_server *server = c->server;
    c->closing = true;
    drop_protocol(c);
    if (c->due)
        forget_due(c);
    *c->self = c->next;
    if (c->next)
        c->next->self = c->self;
    quota_leave(server->quota, c->key);
    count(server, -1);
    listeners_freed(server, c->borrows_reserve);
    free(c->key);
    free(c->address_key);
    free(c);
}

void connection_close(struct connection *c) {
    if (c->closing)
        return;
    c->closing = true;
    peer_close(c->peer);
}

const struct peer_calls connection_calls = {on_read, on_eof, on_sent, on_closed};

void connections_close(struct http_server *server) {
    for (struct connection *c = server->open; c; c = c->next) {
        drop_protocol(c);
        connection_close(c);
    }
}

static void connections_due(uv_idle_t *idle) {
    struct http_server *server = idle->data;
    uv_idle_stop(idle);
    for (struct connection *c; (c = server->due);) {
        server->due = c->next_due;
        c->due = false;
        if (!c->closing && c->protocol && c->protocol->go_on)
            c->protocol->go_on(c);
    }
}

void connection_later(struct connection *c) {
    if (c->due || c->closing)
        return;
    c->due = true;
    c->next_due = c->server->due;
    c->server->due = c;
    uv_idle_start(c->server->idle, connections_due);
}

uint32_t connection_number(const struct connection *c) {
    return c->number;
}

const char *connection_address(const struct connection *c) {
    return c->address_key;
}
