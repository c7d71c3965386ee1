/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket client: how it comes and goes. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/socket_internal.h"
#include <stdlib.h>
#include <string.h>

/* A message that is too long is told so, and dropped. So many times as long, and the connection goes, too. */
enum { MESSAGE_TIMES = 16 };

/* Clients wait half a minute for the answer to their close. */
enum { HANG_UP_MS = 25000 };

/* What is kept of the beginning of a message that is too long, bytes. */
enum { HEAD_BYTES = 512 };

static void warn(void *socket, const struct error *e) {
    json_t *warning = message_error(e);
    json_object_set_new(warning, "type", json_string("warning"));
    socket_say(socket, warning);
}

/* What the address asks for, besides the defaults of requests. */
static void read_query(struct socket *s, const struct http_request *from) {
    static const char *const more[] = {"room",     "audio", "fap", "events",
                                       "kilobits", "watch", "key", NULL}; /* the last is for proxies */
    static const struct members known = {.speech = true, .more = more};
    const struct media_wish wish = {http_query(from, "audio"), http_query(from, "fap"),
                                    http_query(from, "events"), http_query(from, "kilobits")};
    const char *room = http_query(from, "room");
    struct error e;
    query_check(from, &known, false, warn, s);
    if (request_from_query(&s->defaults, from, NULL, &e) || socket_set_media(s, &wish, &e))
        socket_complain(s, &e);
    s->defaults.open = false; /* that is for each utterance to say */
    bool watch;
    if (query_flag(http_query(from, "watch"), "watch", &watch, &e) ||
        (room && socket_join(s, room, watch, NULL, &e)))
        socket_complain(s, &e);
}

static void piece(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last) {
    struct socket *s = ctx;
    if (s->closing)
        return;
    s->too_long |= s->message.size + size > s->net->options.message_bytes;
    if (!s->too_long && (!binary || s->voice))
        buf_add(&s->message, bytes, size);
    else if (s->too_long && !binary && s->message.size < HEAD_BYTES) /* its id, for who is told */
        buf_add(&s->message, bytes,
                size < HEAD_BYTES - s->message.size ? size : HEAD_BYTES - s->message.size);
    if (last)
        socket_hear(s, binary);
}

static void ping(void *ctx, const uint8_t *payload, size_t size) {
    socket_pong(ctx, payload, size);
}

static void pong(void *ctx) {
    (void)ctx; /* it has been heard */
}

/* One that types, and has come to the end of what it was to type, hears the rest of what it had said: its
 * close is answered after that (RFC 6455, 5.5.1, leaves that open). */
static void closed(void *ctx, enum websocket_status status) {
    struct socket *s = ctx;
    if (s->plain && !socket_room(s) && stream_busy(socket_stream(s))) {
        s->hangs_up = status;
        s->hang_up_by = connection_now(s->connection) + HANG_UP_MS;
    } else {
        socket_farewell(s, status, "");
    }
}

static void fault(void *ctx, enum websocket_status status, const char *why, uint64_t byte) {
    struct socket *s = ctx;
    struct error e;
    if (status == WEBSOCKET_BAD_TEXT && !s->closing) {
        error_at_byte(&e, ERROR_BAD_UTF8, (size_t)byte, "a text must be UTF-8");
        socket_complain(s, &e);
    } else if (status == WEBSOCKET_TOO_LARGE && !s->closing) {
        error_set(&e, ERROR_MESSAGE_TOO_LONG, "a message may have at most %u bytes",
                  s->net->options.message_bytes);
        socket_complain(s, &e);
    }
    socket_farewell(s, status, why);
}

void socket_heard(struct socket *s) {
    s->last_rx = connection_now(s->connection);
    s->probe = PROBE_NONE;
}

static void close_socket(struct connection *c) {
    struct socket *s = c->socket;
    c->socket = NULL;
    *s->self = s->next;
    if (s->next)
        s->next->self = s->self;
    write_leave(s);
    desks_leave(&s->follower);
    socket_forget_long(s);
    request_free(&s->defaults);
    buf_free(&s->message);
    buf_free(&s->unread);
    websocket_reader_free(&s->reader);
    message_queue_close(&s->queue);
    queued_message_release(s->leaving);
    queued_message_release(s->pong);
    free(s);
}

static void read_bytes(struct connection *c, const char *bytes, size_t size) {
    struct socket *s = c->socket;
    socket_heard(s);
    size_t taken = websocket_reader_feed(&s->reader, (const uint8_t *)bytes, size);
    buf_add(&s->unread, bytes + taken, size - taken);
}

/* A socket that has been silent is asked whether it is still there (RFC 6455, 5.5.2), and closed when it does
 * not answer. */
static void look(struct connection *c) {
    struct socket *s = c->socket;
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

static void on_sent(struct connection *c) {
    socket_go_on(c->socket);
}

void socket_open(struct connection *c, const struct http_request *request, const struct buf *head,
                 bool plain) {
    static const struct connection_protocol protocol = {
        .read = read_bytes, .sent = on_sent, .look = look, .free = close_socket};
    static const struct websocket_ear ear = {piece, ping, pong, closed, fault};
    struct net *net = c->net;
    struct socket *s = mem_alloc(sizeof *s);
    struct error e = {0};
    s->net = net;
    s->connection = c;
    s->next = net->sockets;
    s->self = &net->sockets;
    if (s->next)
        s->next->self = &s->next;
    net->sockets = s;
    c->socket = s;
    c->name = s->name;
    connection_use(c, &protocol);
    s->reader = (struct websocket_reader){
        .ear = &ear, .ctx = s, .most = (uint64_t)MESSAGE_TIMES * net->options.message_bytes};
    message_queue_open(&s->queue);
    socket_heard(s);
    s->number = ++net->streams;
    snprintf(s->name, sizeof s->name, "s%llu", (unsigned long long)s->number);
    request_init(&s->defaults);
    s->plain = plain;
    s->hear = plain ? text_hear : socket_hear_json;
    s->follower = (struct follower){.encoding = s->plain ? encoding_none : encoding_default,
                                    .media = !s->plain,
                                    .lines = s->plain,
                                    .queue = &s->queue,
                                    .deliver = socket_deliver};
    socket_enter(s, channel_new(net, s->name));
    struct queued_message *answer = queued_message_plain(head->data, head->size);
    message_queue_push(&s->queue, answer);
    queued_message_release(answer);
    socket_say(s, message_hello(net, s->name));
    if (principal_enter(net, request, &s->principal, &e))
        socket_complain(s, &e);
    read_query(s, request);
}

bool sockets_busy(const struct net *net) {
    for (const struct socket *s = net->sockets; s; s = s->next)
        if (s->leaving || connection_unsent(s->connection) || !message_queue_empty(&s->queue) ||
            stream_busy(socket_stream(s)) || channel_pending(s->follower.channel))
            return true;
    return false;
}

void sockets_dismiss(struct net *net, const char *reason) {
    for (struct socket *s = net->sockets; s; s = s->next)
        socket_dismiss(s, WEBSOCKET_GOING_AWAY, reason);
}
