/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/bridges/satellite/wyoming_link.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { READ_SIZE = 65536, COME_MOST = 8 << 20, UNSENT_MOST = 16 << 20, FAREWELL_MS = 2000 };

struct wyoming_link {
    uv_tcp_t tcp;
    uv_timer_t timer; /* of the farewell; of an end that must be told outside a caller's call */
    uv_connect_t connect;
    uv_getaddrinfo_t find;
    uv_shutdown_t shutdown;
    const struct wyoming_link_calls *calls;
    void *ctx;
    struct buf come, waiting; /* waiting: sent once the connection is open */
    const char *why;          /* of the end */
    bool open, closing, closed, finding;
    unsigned handles;
};

static void free_link(struct wyoming_link *l) {
    if (l->handles || l->finding)
        return;
    buf_free(&l->come);
    buf_free(&l->waiting);
    free(l);
}

static void on_closed(uv_handle_t *handle) {
    struct wyoming_link *l = handle->data;
    l->handles--;
    free_link(l);
}

static void shut(struct wyoming_link *l) {
    if (l->closed)
        return;
    l->closed = true;
    uv_close((uv_handle_t *)&l->tcp, on_closed);
    uv_close((uv_handle_t *)&l->timer, on_closed);
}

/* Tells the owner of the end, unless it has closed the link. */
static void end(struct wyoming_link *l, const char *why) {
    const bool tell = !l->closing && !l->closed;
    l->closing = true;
    shut(l);
    if (tell)
        l->calls->ended(l->ctx, why);
}

static void on_timer(uv_timer_t *timer) {
    struct wyoming_link *l = timer->data;
    end(l, l->why);
}

/* Ends the link later: the owner is in the middle of a call. */
static void end_soon(struct wyoming_link *l, const char *why) {
    l->why = why;
    uv_timer_start(&l->timer, on_timer, 0, 0);
}

struct sending {
    uv_write_t write;
    struct buf bytes;
};

static void on_sent(uv_write_t *write, int status) {
    struct sending *s = (struct sending *)write;
    struct wyoming_link *l = write->handle->data;
    buf_free(&s->bytes);
    free(s);
    if (status < 0)
        end(l, uv_strerror(status));
}

/* Takes the bytes. */
static void send_bytes(struct wyoming_link *l, struct buf *bytes) {
    struct sending *s = mem_alloc(sizeof *s);
    s->bytes = *bytes;
    *bytes = (struct buf){0};
    const uv_buf_t one = uv_buf_init((char *)s->bytes.data, (unsigned)s->bytes.size);
    if (uv_write(&s->write, (uv_stream_t *)&l->tcp, &one, 1, on_sent)) {
        buf_free(&s->bytes);
        free(s);
        end_soon(l, "the connection failed");
    }
}

void wyoming_link_tell(struct wyoming_link *l, const char *type, json_t *data, const void *payload,
                       size_t size) {
    if (l->closing || l->closed) {
        json_decref(data);
        return;
    }
    wyoming_event_write(&l->waiting, type, data, payload, size);
    if (l->waiting.size + l->tcp.write_queue_size > UNSENT_MOST)
        end_soon(l, "it does not read what it is sent");
    else if (l->open)
        send_bytes(l, &l->waiting);
}

static void take(struct wyoming_link *l) {
    struct wyoming_event event;
    const char *why = NULL;
    int whole = 0;
    while (!l->closing && (whole = wyoming_event_next(&l->come, &event, &why)) > 0) {
        l->calls->event(l->ctx, &event);
        wyoming_event_free(&event);
    }
    if (whole < 0)
        end(l, why);
}

static void on_alloc(uv_handle_t *handle, size_t wanted, uv_buf_t *into) {
    struct wyoming_link *l = handle->data;
    (void)wanted;
    *into = uv_buf_init(buf_reserve(&l->come, READ_SIZE), READ_SIZE);
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *bytes) {
    struct wyoming_link *l = stream->data;
    (void)bytes;
    if (count < 0 || l->come.size + (size_t)count > COME_MOST) {
        end(l, count < 0 && count != UV_EOF ? uv_strerror((int)count) : "it hung up");
        return;
    }
    l->come.size += (size_t)count;
    if (l->closing)
        l->come.size = 0; /* reads on, so that a reset does not discard what is being sent */
    else
        take(l);
}

static struct wyoming_link *new_link(uv_loop_t *loop, const struct wyoming_link_calls *calls, void *ctx) {
    struct wyoming_link *l = mem_alloc(sizeof *l);
    *l = (struct wyoming_link){.calls = calls, .ctx = ctx, .why = "it hung up"};
    uv_tcp_init(loop, &l->tcp);
    uv_timer_init(loop, &l->timer);
    l->tcp.data = l->timer.data = l->connect.data = l->find.data = l->shutdown.data = l;
    l->handles = 2;
    return l;
}

static void begin(struct wyoming_link *l) {
    l->open = true;
    uv_tcp_nodelay(&l->tcp, 1);
    uv_read_start((uv_stream_t *)&l->tcp, on_alloc, on_read);
    if (l->waiting.size)
        send_bytes(l, &l->waiting);
}

struct wyoming_link *wyoming_link_accept(uv_stream_t *listener, const struct wyoming_link_calls *calls,
                                         void *ctx) {
    struct wyoming_link *l = new_link(listener->loop, calls, ctx);
    if (!uv_accept(listener, (uv_stream_t *)&l->tcp)) {
        begin(l);
        return l;
    }
    l->closing = true;
    shut(l);
    return NULL;
}

static void on_connected(uv_connect_t *connect, int status) {
    struct wyoming_link *l = connect->data;
    if (status)
        end(l, uv_strerror(status));
    else if (!l->closed)
        begin(l);
}

static void on_found(uv_getaddrinfo_t *find, int status, struct addrinfo *found) {
    struct wyoming_link *l = find->data;
    l->finding = false;
    if (l->closed)
        free_link(l);
    else if (status || uv_tcp_connect(&l->connect, &l->tcp, found->ai_addr, on_connected))
        end(l, status ? uv_strerror(status) : "no connection is possible");
    uv_freeaddrinfo(found);
}

/* Splits HOST:PORT or [HOST]:PORT. Returns the port, or NULL. */
static const char *split(const char *address, char host[256]) {
    const char *port = strrchr(address, ':');
    const bool bracketed = *address == '[';
    if (!port || !port[1] || port[1 + strspn(port + 1, "0123456789")] || atoi(port + 1) > 65535)
        return NULL;
    const int length = (int)(port - address) - 2 * bracketed;
    if (length < 1 || length > 255 || snprintf(host, 256, "%.*s", length, address + bracketed) < 1)
        return NULL;
    return port + 1;
}

bool wyoming_address_check(const char *address) {
    char host[256];
    return split(address, host);
}

struct wyoming_link *wyoming_link_connect(uv_loop_t *loop, const char *address,
                                          const struct wyoming_link_calls *calls, void *ctx) {
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    struct wyoming_link *l = new_link(loop, calls, ctx);
    char host[256];
    const char *port = split(address, host);
    l->finding = port && !uv_getaddrinfo(loop, &l->find, on_found, host, port, &hints);
    if (!l->finding)
        end_soon(l, "its address is invalid");
    return l;
}

static void on_shut(uv_shutdown_t *shutdown, int status) {
    struct wyoming_link *l = shutdown->data;
    if (status)
        shut(l);
}

void wyoming_link_close(struct wyoming_link *l) {
    if (!l || l->closing)
        return;
    l->closing = true;
    if (!l->open || uv_shutdown(&l->shutdown, (uv_stream_t *)&l->tcp, on_shut))
        shut(l);
    else
        uv_timer_start(&l->timer, on_timer, FAREWELL_MS, 0);
}
