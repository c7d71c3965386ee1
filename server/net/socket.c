/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket client: how it comes and goes, the room it is in, and what it may have said. */
#include "server/base/mem.h"
#include "server/net/socket_internal.h"
#include <stdlib.h>
#include <string.h>

/* A message that is too long is told so, and dropped. So many times as long, and the connection goes, too. */
enum { MESSAGE_TIMES = 16 };

/* Clients wait half a minute for the answer to their close. */
enum { HANG_UP_MS = 25000 };

void socket_enter(struct socket *s, struct channel *channel) {
    s->follower.idle = false;
    channel_join(channel, &s->follower);
}

struct stream *socket_stream(const struct socket *s) {
    return channel_stream(s->follower.channel);
}

const char *socket_room(const struct socket *s) {
    const struct channel *c = s->follower.channel;
    return channel_is_room(c) ? channel_name(c) : NULL;
}

int socket_join(struct socket *s, const char *room, struct error *e) {
    struct error ignored;
    if (principal_may(s->net, &s->principal, RIGHT_LISTEN, room, e))
        return -1;
    struct channel *channel = channel_room(s->net, room, e);
    if (!channel || channel == s->follower.channel)
        return channel ? 0 : -1;
    channel_leave(&s->follower);
    socket_say(s, json_pack("{ss ss si sb}", "type", "joined", "room", room, "followers",
                            (int)channel_followers(channel) + 1, "may_speak",
                            !principal_may(s->net, &s->principal, RIGHT_SPEAK, room, &ignored)));
    socket_enter(s, channel);
    return 0;
}

void socket_leave(struct socket *s) {
    socket_say(s, json_pack("{ss ss}", "type", "left", "room", socket_room(s)));
    channel_leave(&s->follower);
    socket_enter(s, channel_new(s->net, s->name));
}

int socket_set_media(struct socket *s, const struct media_wish *wish, struct error *e) {
    struct encoding encoding = s->follower.encoding;
    int codec = 0;
    if (wish->audio && (codec = encoding_audio(wish->audio, e)) < 0)
        return -1;
    if (wish->audio)
        encoding.audio = (uint8_t)codec;
    if (wish->fap && (codec = encoding_fap(wish->fap, e)) < 0)
        return -1;
    if (wish->fap)
        encoding.fap = (uint8_t)codec;
    if (wish->kilobits && (codec = encoding_kilobits(wish->kilobits)) < 0)
        return error_in_field(e, ERROR_BAD_FIELD, "kilobits",
                              "must be a number of kilobits a second, 6 to 64");
    if (wish->kilobits)
        encoding.kilobits = (uint8_t)codec;
    int packed = wish->events ? encoding_events(wish->events) : encoding.packed;
    if (packed < 0)
        return error_in_field(e, ERROR_UNKNOWN_CODEC, "events", "no form of events '%s'", wish->events);
    encoding.packed = packed;
    if (!encoding_possible(&encoding))
        return error_in_field(e, ERROR_UNKNOWN_CODEC, "fap",
                              "plain FAPs do not go with Opus: ask for fapc, or for pcm");
    channel_want(&s->follower, &encoding);
    return 0;
}

static void warn(void *socket, const struct error *e) {
    json_t *warning = message_error(e);
    json_object_set_new(warning, "type", json_string("warning"));
    socket_say(socket, warning);
}

/* What the address asks for, besides the defaults of requests. */
static void read_query(struct socket *s, const struct http_request *from) {
    static const char *const more[] = {"room", "audio", "fap", "events", "kilobits", NULL};
    static const struct members known = {.speech = true, .more = more};
    const struct media_wish wish = {http_query(from, "audio"), http_query(from, "fap"),
                                    http_query(from, "events"), http_query(from, "kilobits")};
    const char *room = http_query(from, "room");
    struct error e;
    query_check(from, &known, false, warn, s);
    if (request_from_query(&s->defaults, from, NULL, &e) || socket_set_media(s, &wish, &e))
        socket_complain(s, &e);
    if (room && socket_join(s, room, &e))
        socket_complain(s, &e);
}

static void piece(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last) {
    struct socket *s = ctx;
    if (s->closing)
        return;
    s->too_long |= s->message.size + size > s->net->options.message_bytes;
    if (!binary && !s->too_long)
        buf_add(&s->message, bytes, size);
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
        error_set(&e, ERROR_MESSAGE_TOO_LONG, "a message may have %u bytes", s->net->options.message_bytes);
        socket_complain(s, &e);
    }
    socket_farewell(s, status, why);
}

void socket_open(struct connection *c, const struct http_request *request, const struct buf *head,
                 bool plain) {
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
    s->reader = (struct websocket_reader){
        .ear = &ear, .ctx = s, .most = (uint64_t)MESSAGE_TIMES * net->options.message_bytes};
    message_queue_open(&s->queue);
    socket_heard(s);
    s->number = ++net->streams;
    snprintf(s->name, sizeof s->name, "s%llu", (unsigned long long)s->number);
    request_init(&s->defaults);
    s->plain = plain;
    s->follower = (struct follower){.encoding = s->plain ? encoding_none : encoding_default,
                                    .media = !s->plain,
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

void socket_close(struct socket *s) {
    *s->self = s->next;
    if (s->next)
        s->next->self = s->self;
    channel_leave(&s->follower);
    request_free(&s->defaults);
    buf_free(&s->message);
    websocket_reader_free(&s->reader);
    message_queue_close(&s->queue);
    queued_message_release(s->leaving);
    queued_message_release(s->pong);
    free(s);
}

void socket_read(struct socket *s, const char *bytes, size_t size) {
    socket_heard(s);
    websocket_reader_feed(&s->reader, (const uint8_t *)bytes, size);
}

/* In a room, others need not hear of it. */
void socket_refuse(struct socket *s, const char *id, const struct error *e) {
    if (!socket_room(s)) {
        stream_refuse(socket_stream(s), id, e);
        return;
    }
    json_t *error = message_error(e), *end = json_pack("{ss ss}", "type", "end", "reason", "failed");
    if (id) {
        json_object_set_new(error, "id", json_string(id));
        json_object_set_new(end, "id", json_string(id));
    }
    socket_say(s, error);
    socket_say(s, end);
}

int socket_may_direct(struct socket *s, struct error *e) {
    return principal_may(s->net, &s->principal, RIGHT_SPEAK, socket_room(s), e);
}

int socket_may_speak(struct socket *s, struct error *e) {
    if (socket_may_direct(s, e) || principal_ask(s->net, &s->principal, e))
        return -1;
    return s->net->draining ? error_plain(e, ERROR_STOPPING) : 0;
}

void socket_speak_request(struct socket *s, const struct speech_request *request) {
    unsigned limit = s->net->options.text_bytes;
    struct error e;
    int refused = socket_may_speak(s, &e);
    if (!refused && request->text_size > limit)
        refused = error_in_field(&e, ERROR_TEXT_TOO_LONG, "text", "a text may have %u bytes", limit);
    if (refused)
        socket_refuse(s, request->id, &e);
    else
        stream_speak(socket_stream(s), request);
}

void socket_speak(struct socket *s, const char *text, size_t size) {
    struct speech_request request;
    struct error e;
    request_copy(&request, &s->defaults);
    request_set(&request, "text", (struct request_value){REQUEST_STRING, text, size, 0}, &e);
    socket_speak_request(s, &request);
    request_free(&request);
}
