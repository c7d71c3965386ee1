/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/lva/websocket_client.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/doors/websocket_ask.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    AGAIN_MS = 500,
    AGAIN_MOST_MS = 10000,
    OPEN_MS = 10000,     /* within which it must be open */
    STEADY_MS = 5000,    /* open for so long, and the next try after it comes soon again */
    UNSENT_MOST = 65536, /* bytes of answers to pings that it does not take */
    COME_MOST = WEBSOCKET_TEXT_MOST + 65536,
    KEEPALIVE_SECONDS = 30
};

struct websocket_client {
    uv_loop_t *loop;
    uv_timer_t timer;
    struct wire *wire; /* NULL: none */
    char host[256], port[8], path[512];
    struct websocket_calls calls;
    void *ctx;
    unsigned wait; /* ms before the next try */
};

/* One connection. It frees itself when its handle is closed. */
struct wire {
    uv_tcp_t tcp;
    uv_getaddrinfo_t lookup;
    uv_connect_t connecting;
    struct websocket_client *client; /* NULL: let go */
    wslay_event_context_ptr frames;
    struct buf come;
    size_t taken;
    char answer[WEBSOCKET_ANSWER_BYTES];
    uint64_t since; /* loop time at which it was opened, ms */
    bool looks_up, open, closing, closed; /* closed: only its look-up keeps it */
};

static void start(struct websocket_client *c);

static void free_wire(struct wire *w) {
    if (w->frames)
        wslay_event_context_free(w->frames);
    buf_free(&w->come);
    free(w);
}

static void on_wire_closed(uv_handle_t *handle) {
    struct wire *w = handle->data;
    w->closed = true;
    if (!w->looks_up)
        free_wire(w);
}

static void close_wire(struct wire *w) {
    if (w->client)
        w->client->wire = NULL;
    w->client = NULL;
    if (!w->closing)
        uv_close((uv_handle_t *)&w->tcp, on_wire_closed);
    w->closing = true;
}

static void on_again(uv_timer_t *timer) {
    start(timer->data);
}

static void lose(struct wire *w, const char *why) {
    struct websocket_client *c = w->client;
    if (!c)
        return;
    if (w->open && uv_now(c->loop) - w->since >= STEADY_MS)
        c->wait = AGAIN_MS;
    close_wire(w);
    uv_timer_start(&c->timer, on_again, c->wait, 0);
    c->wait = c->wait * 2 < AGAIN_MOST_MS ? c->wait * 2 : AGAIN_MOST_MS;
    c->calls.lost(c->ctx, why);
}

static void on_silence(uv_timer_t *timer) {
    struct websocket_client *c = timer->data;
    lose(c->wire, "it does not answer");
}

struct sending {
    uv_write_t write;
    char bytes[];
};

static void on_sent(uv_write_t *write, int status) {
    struct wire *w = write->handle->data;
    free(write);
    if (status < 0 && status != UV_ECANCELED)
        lose(w, uv_strerror(status));
}

static void send_bytes(struct wire *w, const void *bytes, size_t size) {
    if (w->closing)
        return;
    struct sending *s = mem_alloc(sizeof *s + size);
    memcpy(s->bytes, bytes, size);
    uv_buf_t buf = uv_buf_init(s->bytes, (unsigned)size);
    uv_write(&s->write, (uv_stream_t *)&w->tcp, &buf, 1, on_sent);
}

static ssize_t on_frames_send(wslay_event_context_ptr frames, const uint8_t *data, size_t size, int flags,
                              void *ctx) {
    (void)frames;
    (void)flags;
    send_bytes(ctx, data, size);
    return (ssize_t)size;
}

static ssize_t on_frames_take(wslay_event_context_ptr frames, uint8_t *data, size_t size, int flags,
                              void *ctx) {
    struct wire *w = ctx;
    size_t there = w->come.size - w->taken, count = there < size ? there : size;
    (void)flags;
    if (!count) {
        wslay_event_set_error(frames, WSLAY_ERR_WOULDBLOCK);
        return -1;
    }
    memcpy(data, w->come.data + w->taken, count);
    w->taken += count;
    return (ssize_t)count;
}

static void on_message(wslay_event_context_ptr frames, const struct wslay_event_on_msg_recv_arg *message,
                       void *ctx) {
    struct wire *w = ctx;
    (void)frames;
    if (message->opcode == WSLAY_TEXT_FRAME && w->client)
        w->client->calls.text(w->client->ctx, (const char *)message->msg, message->msg_length);
}

static void ask(struct wire *w) {
    struct websocket_client *c = w->client;
    struct buf head = {0}, host = {0};
    buf_printf(&host, "%s:%s", c->host, c->port);
    buf_add(&host, "", 1);
    websocket_ask(&head, (char *)host.data, c->path, NULL, w->answer);
    send_bytes(w, head.data, head.size);
    buf_free(&host);
    buf_free(&head);
}

/* The server's answer: true when what follows are frames. */
static bool take_head(struct wire *w) {
    static const struct wslay_event_callbacks callbacks = {.recv_callback = on_frames_take,
                                                           .send_callback = on_frames_send,
                                                           .genmask_callback = websocket_mask,
                                                           .on_msg_recv_callback = on_message};
    char *end = w->come.size ? memmem(w->come.data, w->come.size, "\r\n\r\n", 4) : NULL;
    if (!end) {
        if (w->come.size > WEBSOCKET_HEAD_MOST)
            lose(w, "its answer is too long");
        return false;
    }
    end[2] = '\0';
    const char *head = (char *)w->come.data;
    if (!websocket_answered(head, w->answer)) {
        lose(w, "there is no WebSocket");
        return false;
    }
    buf_consume(&w->come, (size_t)(end + 4 - head));
    wslay_event_context_client_init(&w->frames, &callbacks, w);
    wslay_event_config_set_max_recv_msg_length(w->frames, WEBSOCKET_TEXT_MOST);
    w->open = true;
    w->since = uv_now(w->client->loop);
    uv_timer_stop(&w->client->timer);
    w->client->calls.open(w->client->ctx);
    return true;
}

static void on_alloc(uv_handle_t *handle, size_t wanted, uv_buf_t *buf) {
    struct wire *w = handle->data;
    (void)wanted;
    *buf = uv_buf_init(buf_reserve(&w->come, 65536), 65536);
}

static void on_read(uv_stream_t *stream, ssize_t count, const uv_buf_t *buf) {
    struct wire *w = stream->data;
    (void)buf;
    if (count < 0) {
        lose(w, uv_strerror((int)count));
        return;
    }
    w->come.size += (size_t)count;
    if (!w->client || (!w->open && !take_head(w)))
        return;
    w->taken = 0;
    int failed = wslay_event_recv(w->frames) || wslay_event_send(w->frames);
    buf_consume(&w->come, w->taken);
    if (wslay_event_get_close_received(w->frames))
        lose(w, "it was closed");
    else if (failed || !wslay_event_get_read_enabled(w->frames)) /* wslay reads no more: a close was sent */
        lose(w, "it sends what is no WebSocket message, or one that is too long");
    else if (w->tcp.write_queue_size > UNSENT_MOST || w->come.size > COME_MOST)
        lose(w, "it does not take what is sent");
}

static void on_connect(uv_connect_t *connecting, int status) {
    struct wire *w = connecting->handle->data;
    if (!w->client)
        return;
    if (status < 0) {
        lose(w, uv_strerror(status));
        return;
    }
    uv_tcp_keepalive(&w->tcp, 1, KEEPALIVE_SECONDS);
    uv_read_start((uv_stream_t *)&w->tcp, on_alloc, on_read);
    ask(w);
}

static void connect_to(struct wire *w, const struct addrinfo *found) {
    int failed = uv_tcp_connect(&w->connecting, &w->tcp, found->ai_addr, on_connect);
    if (failed)
        lose(w, uv_strerror(failed));
}

static void on_found(uv_getaddrinfo_t *lookup, int status, struct addrinfo *found) {
    struct wire *w = (struct wire *)((char *)lookup - offsetof(struct wire, lookup));
    w->looks_up = false;
    if (w->closed)
        free_wire(w);
    else if (w->closing)
        ; /* the handle's end frees it */
    else if (status < 0)
        lose(w, uv_strerror(status));
    else
        connect_to(w, found);
    uv_freeaddrinfo(found);
}

static void start(struct websocket_client *c) {
    struct wire *w = c->wire = mem_alloc(sizeof *w);
    const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    w->client = c;
    uv_tcp_init(c->loop, &w->tcp);
    w->tcp.data = w;
    w->looks_up = !uv_getaddrinfo(c->loop, &w->lookup, on_found, c->host, c->port, &hints);
    uv_timer_start(&c->timer, on_silence, OPEN_MS, 0);
    if (!w->looks_up)
        lose(w, "its name cannot be looked up");
}

struct websocket_client *websocket_client_new(uv_loop_t *loop, const char *url,
                                              const struct websocket_calls *calls, void *ctx) {
    struct websocket_client *c = mem_alloc(sizeof *c);
    int got = sscanf(url, "ws://%255[^:/]:%7[0-9]%511s", c->host, c->port, c->path);
    if (got < 2 || (got == 3 && *c->path != '/')) {
        free(c);
        return NULL;
    }
    if (got == 2)
        strcpy(c->path, "/");
    c->loop = loop;
    c->calls = *calls;
    c->ctx = ctx;
    c->wait = AGAIN_MS;
    uv_timer_init(loop, &c->timer);
    c->timer.data = c;
    start(c);
    return c;
}

static void free_client(uv_handle_t *handle) {
    free(handle->data);
}

void websocket_client_free(struct websocket_client *c) {
    if (!c)
        return;
    if (c->wire)
        close_wire(c->wire);
    uv_close((uv_handle_t *)&c->timer, free_client);
}
