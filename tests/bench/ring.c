/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reference of broadcast.mjs: the minimum that libwebsockets must do to send the same messages to many
 * connections. All messages are in one ring; a connection that falls a whole round behind is closed.
 * (lws_ring would cost more, because it searches for the slowest connection again and again.) Usage: ring
 * FILE; prints its port, and on SIGUSR1 plays the messages of FILE, as listeners.c records them, at their
 * times. Ends with SIGTERM. */
#include <libwebsockets.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

enum { RING = 1024, HEAD = 9 };

struct message {
    uint8_t *bytes; /* after space for the frame header */
    size_t size;
    enum lws_write_protocol type;
};

struct session {
    struct session *next;
    struct lws *wsi;
    size_t next_message;
};

struct ring {
    uv_loop_t loop;
    uv_timer_t timer;
    uv_signal_t start, stop;
    struct lws_context *context;
    struct message messages[RING];
    size_t count; /* messages so far */
    struct session *sessions;
    uint8_t *file;
    size_t size, at;
    uint64_t started;
};

static uint32_t number(const uint8_t *at) {
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void send_message(struct ring *r, const uint8_t *record) {
    struct message m = {.size = number(record + 5),
                        .type = record[4] == 1 ? LWS_WRITE_TEXT : LWS_WRITE_BINARY};
    m.bytes = malloc(LWS_PRE + m.size);
    memcpy(m.bytes + LWS_PRE, record + HEAD, m.size);
    struct message *slot = &r->messages[r->count++ % RING];
    free(slot->bytes);
    *slot = m;
    for (struct session *s = r->sessions; s; s = s->next)
        lws_callback_on_writable(s->wsi);
}

/* Sends due messages. Times are ms since the first message. */
static void on_timer(uv_timer_t *timer) {
    struct ring *r = timer->data;
    uint64_t now = uv_now(&r->loop) - r->started;
    while (r->at + HEAD <= r->size && number(r->file + r->at) <= now) {
        send_message(r, r->file + r->at);
        r->at += HEAD + number(r->file + r->at + 5);
    }
    if (r->at + HEAD <= r->size)
        uv_timer_start(timer, on_timer, number(r->file + r->at) - now, 0);
}

static void on_start(uv_signal_t *signal, int number) {
    struct ring *r = signal->data;
    (void)number;
    r->at = 0;
    uv_update_time(&r->loop);
    r->started = uv_now(&r->loop);
    on_timer(&r->timer);
}

static void on_stop(uv_signal_t *signal, int number) {
    (void)number;
    uv_stop(signal->loop);
}

static void forget(struct ring *r, struct session *gone) {
    lws_start_foreach_llp(struct session **, at, r->sessions) {
        if (*at == gone) {
            *at = gone->next;
            break;
        }
    }
    lws_end_foreach_llp(at, next);
}

static int on_writeable(struct ring *r, struct session *s) {
    if (s->next_message == r->count)
        return 0;
    if (r->count - s->next_message > RING)
        return -1;
    const struct message *m = &r->messages[s->next_message++ % RING];
    if (lws_write(s->wsi, m->bytes + LWS_PRE, m->size, m->type) < (int)m->size)
        return -1;
    if (s->next_message < r->count)
        lws_callback_on_writable(s->wsi);
    return 0;
}

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    struct ring *r = lws_context_user(lws_get_context(wsi));
    struct session *s = user;
    (void)in;
    (void)size;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
        s->wsi = wsi;
        s->next_message = r->count;
        s->next = r->sessions;
        r->sessions = s;
        return 0;
    case LWS_CALLBACK_CLOSED:
        forget(r, s);
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return on_writeable(r, s);
    default:
        return 0;
    }
}

static int read_all(struct ring *r, const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END))
        return -1;
    r->size = (size_t)ftell(file);
    r->file = malloc(r->size + 1);
    rewind(file);
    size_t got = fread(r->file, 1, r->size, file);
    fclose(file);
    return got == r->size ? 0 : -1;
}

int main(int argc, char **argv) {
    static const struct lws_protocols protocols[] = {
        {"ring", callback, sizeof(struct session), 0, 0, NULL, 0}, {0}};
    static struct ring r;
    if (argc != 2 || read_all(&r, argv[1])) {
        fprintf(stderr, "usage: ring FILE\n");
        return 2;
    }
    uv_loop_init(&r.loop);
    uv_timer_init(&r.loop, &r.timer);
    uv_signal_init(&r.loop, &r.start);
    uv_signal_init(&r.loop, &r.stop);
    r.timer.data = r.start.data = &r;
    void *loops[] = {&r.loop};
    struct lws_context_creation_info info = {.port = 0,
                                             .iface = "127.0.0.1",
                                             .protocols = protocols,
                                             .foreign_loops = loops,
                                             .options =
                                                 LWS_SERVER_OPTION_LIBUV | LWS_SERVER_OPTION_EXPLICIT_VHOSTS,
                                             .user = &r};
    lws_set_log_level(LLL_ERR, NULL);
    r.context = lws_create_context(&info);
    struct lws_vhost *vhost = r.context ? lws_create_vhost(r.context, &info) : NULL;
    if (!vhost)
        return 1;
    uv_signal_start(&r.start, on_start, SIGUSR1);
    uv_signal_start(&r.stop, on_stop, SIGTERM);
    printf("%d\n", lws_get_vhost_listen_port(vhost));
    fflush(stdout);
    uv_run(&r.loop, UV_RUN_DEFAULT);
    return 0; /* the exit frees the rest */
}
