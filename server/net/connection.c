/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/connection.h"
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FINISH_MS = 2000,    /* for the other end to close */
    UNSENT_BYTES = 16384 /* in the kernel */
};

uint64_t connection_now(const struct connection *c) {
    return uv_now(c->net->pipeline->loop);
}

/* What the connections of one client are counted by: of IPv6, it has a whole network. */
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

static void on_bytes(uv_stream_t *stream, ssize_t size, const uv_buf_t *buffer) {
    struct connection *c = stream->data;
    if (size == 0 || (size > 0 && c->finished))
        return;
    if (size < 0 && (size != UV_EOF || c->finished || !c->protocol->eof))
        connection_close(c);
    else if (size < 0)
        c->protocol->eof(c);
    else
        c->protocol->read(c, buffer->base, (size_t)size);
}

/* One buffer serves all: what comes is dealt with before anything else is read. */
static void on_alloc(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer) {
    struct connection *c = handle->data;
    (void)suggested;
    *buffer = uv_buf_init(c->net->read_buffer, NET_READ_BYTES);
}

void connection_read(struct connection *c, bool on) {
    if (c->closing || c->reading == on)
        return;
    c->reading = on;
    if (on)
        uv_read_start(&c->io.stream, on_alloc, on_bytes);
    else
        uv_read_stop(&c->io.stream);
}

static void count(struct net *net, int change) {
    net->connections += (unsigned)change;
    metrics_add(net->pipeline->metrics, METRIC_CONNECTIONS, change);
    if (change > 0)
        metrics_add(net->pipeline->metrics, METRIC_CONNECTIONS_TOTAL, 1);
}

/* What a client does not take shall wait here, where it can be left out, and not in the kernel, which would
 * hide minutes of it: so a connection can be written to only while less than this is unsent (tcp(7)). */
static void keep_kernel_short(int fd) {
    int bytes = UNSENT_BYTES;
    setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &bytes, sizeof bytes);
}

static int open_stream(struct connection *c, int fd, bool unix_socket) {
    uv_loop_t *loop = c->net->pipeline->loop;
    if (unix_socket) {
        uv_pipe_init(loop, &c->io.pipe, 0);
        return uv_pipe_open(&c->io.pipe, fd);
    }
    uv_tcp_init(loop, &c->io.tcp);
    if (uv_tcp_open(&c->io.tcp, fd))
        return -1;
    uv_tcp_nodelay(&c->io.tcp, 1);
    keep_kernel_short(fd);
    return 0;
}

struct connection *connection_open(struct net *net, int fd, const struct sockaddr_storage *peer) {
    struct connection *c = mem_alloc(sizeof *c);
    *c = (struct connection){.net = net, .next = net->open, .self = &net->open, .address_key = key_of(peer)};
    c->number = ++net->numbered ? net->numbered : ++net->numbered;
    c->key = mem_strdup(c->address_key);
    quota_enter(&net->quota, c->key, 0);
    if (c->next)
        c->next->self = &c->next;
    net->open = c;
    count(net, 1);
    int failed = open_stream(c, fd, peer->ss_family == AF_UNIX);
    c->io.handle.data = c;
    if (failed)
        connection_close(c);
    return c;
}

void connection_use(struct connection *c, const struct connection_protocol *protocol) {
    c->protocol = protocol;
    connection_read(c, true);
}

bool connection_count(struct connection *c, const char *key) {
    if (!strcmp(key, c->key))
        return true;
    if (!quota_enter(&c->net->quota, key, c->net->options.address_connections))
        return false;
    quota_leave(&c->net->quota, c->key);
    free(c->key);
    c->key = mem_strdup(key);
    return true;
}

static void tell_protocol(struct connection *c) {
    if (!c->closing)
        c->protocol->sent(c);
}

static void on_sent(uv_write_t *request, int status) {
    struct connection *c = request->data;
    c->sending = false;
    c->progress = connection_now(c);
    if (status)
        connection_close(c);
    tell_protocol(c);
}

size_t connection_try(struct connection *c, const uv_buf_t *buffers, unsigned count) {
    int sent = c->closing ? UV_ECANCELED : uv_try_write(&c->io.stream, buffers, count);
    if (sent == UV_EAGAIN)
        sent = 0;
    else if (sent < 0)
        connection_close(c);
    c->progress = connection_now(c);
    return sent < 0 ? SIZE_MAX : (size_t)sent;
}

bool connection_send(struct connection *c, const void *bytes, size_t size) {
    /* libuv takes the bytes as char * and changes none */
    uv_buf_t buffer = uv_buf_init((char *)(uintptr_t)bytes, (unsigned)size);
    size_t sent = connection_try(c, &buffer, 1);
    if (sent >= size)
        return true;
    buffer.base += sent;
    buffer.len -= sent;
    c->write.data = c;
    if (uv_write(&c->write, &c->io.stream, &buffer, 1, on_sent)) {
        connection_close(c);
        return true;
    }
    c->sending = true;
    c->unsent = connection_unsent(c);
    return false;
}

size_t connection_unsent(const struct connection *c) {
    return c->sending ? uv_stream_get_write_queue_size(&c->io.stream) : 0;
}

void connection_finish(struct connection *c) {
    uv_os_fd_t fd;
    if (c->finished || c->closing)
        return;
    c->finished = true;
    c->end_by = connection_now(c) + FINISH_MS;
    if (uv_fileno(&c->io.handle, &fd) || shutdown(fd, SHUT_WR))
        connection_close(c);
    connection_read(c, true);
}

/* What belongs to it goes with it, or before. */
static void drop_protocol(struct connection *c) {
    if (c->protocol)
        c->protocol->free(c);
    c->protocol = NULL;
}

static void forget_due(struct connection *c) {
    struct connection **at = &c->net->due;
    while (*at && *at != c)
        at = &(*at)->next_due;
    if (*at)
        *at = c->next_due;
}

static void on_closed(uv_handle_t *handle) {
    struct connection *c = handle->data;
    struct net *net = c->net;
    drop_protocol(c);
    if (c->due)
        forget_due(c);
    *c->self = c->next;
    if (c->next)
        c->next->self = c->self;
    quota_leave(&net->quota, c->key);
    count(net, -1);
    net->descriptor_freed(net, c->borrows_reserve);
    free(c->key);
    free(c->address_key);
    free(c);
}

void connection_close(struct connection *c) {
    if (c->closing)
        return;
    c->closing = true;
    uv_close(&c->io.handle, on_closed);
}

void connections_close(struct net *net) {
    for (struct connection *c = net->open; c; c = c->next) {
        drop_protocol(c);
        connection_close(c);
    }
}

static void on_due(uv_idle_t *idle) {
    struct net *net = idle->data;
    uv_idle_stop(idle);
    for (struct connection *c; (c = net->due);) {
        net->due = c->next_due;
        c->due = false;
        if (!c->closing && c->protocol && c->protocol->go_on)
            c->protocol->go_on(c);
    }
}

void connection_later(struct connection *c) {
    if (c->due || c->closing)
        return;
    c->due = true;
    c->next_due = c->net->due;
    c->net->due = c;
    uv_idle_start(c->net->idle, on_due);
}
