/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket client: how it comes and goes, the room it is in, and what it may have said. */
#include "server/base/mem.h"
#include "server/net/socket_parts.h"
#include <stdlib.h>
#include <string.h>

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
    if (guest_may(s->net, &s->guest, RIGHT_LISTEN, room, e))
        return -1;
    struct channel *channel = channel_room(s->net, room, e);
    if (!channel || channel == s->follower.channel)
        return channel ? 0 : -1;
    channel_leave(&s->follower);
    socket_say(s, json_pack("{ss ss si sb}", "type", "joined", "room", room, "followers",
                            (int)channel_followers(channel) + 1, "may_speak",
                            !guest_may(s->net, &s->guest, RIGHT_SPEAK, room, &ignored)));
    socket_enter(s, channel);
    return 0;
}

int socket_set_media(struct socket *s, const struct media_wish *wish, struct error *e) {
    struct encoding encoding = s->follower.encoding;
    int codec = 0;
    if (wish->audio && (codec = encoding_audio(wish->audio)) < 0)
        return error_in_field(e, "unknown-codec", "audio", "no audio codec '%s'", wish->audio);
    if (wish->audio)
        encoding.audio = (uint8_t)codec;
    if (wish->fap && (codec = encoding_fap(wish->fap)) < 0)
        return error_in_field(e, "unknown-codec", "fap", "no FAP codec '%s'", wish->fap);
    if (wish->fap)
        encoding.fap = (uint8_t)codec;
    if (wish->kilobits && (codec = encoding_kilobits(wish->kilobits)) < 0)
        return error_in_field(e, "bad-field", "kilobits", "must be a number of kilobits a second, 6 to 64");
    if (wish->kilobits)
        encoding.kilobits = (uint8_t)codec;
    int packed = wish->events ? encoding_events(wish->events) : encoding.packed;
    if (packed < 0)
        return error_in_field(e, "unknown-codec", "events", "no form of events '%s'", wish->events);
    encoding.packed = packed;
    if (!encoding_possible(&encoding))
        return error_in_field(e, "unknown-codec", "fap",
                              "plain FAPs do not go with Opus: ask for fba, or for pcm");
    channel_want(&s->follower, &encoding);
    return 0;
}

/* What the address asks for, besides the defaults of requests. */
static void read_query(struct socket *s) {
    char room[TOKEN_ROOM + 2], audio[32], fap[32], events[32], kilobits[32];
    struct error e;
    const char *in = lws_get_urlarg_by_name(s->wsi, "room=", room, sizeof room);
    const struct media_wish wish = {
        lws_get_urlarg_by_name(s->wsi, "audio=", audio, sizeof audio),
        lws_get_urlarg_by_name(s->wsi, "fap=", fap, sizeof fap),
        lws_get_urlarg_by_name(s->wsi, "events=", events, sizeof events),
        lws_get_urlarg_by_name(s->wsi, "kilobits=", kilobits, sizeof kilobits),
    };
    if (request_from_query(&s->defaults, s->wsi, NULL, &e) || socket_set_media(s, &wish, &e))
        socket_complain(s, &e);
    if (in && socket_join(s, in, &e))
        socket_complain(s, &e);
}

struct socket *socket_open(struct net *net, struct lws *wsi) {
    struct socket *s = mem_alloc(sizeof *s);
    struct error e = {0};
    s->net = net;
    s->wsi = wsi;
    s->next = net->sockets;
    s->self = &net->sockets;
    if (s->next)
        s->next->self = &s->next;
    net->sockets = s;
    outbox_open(&s->outbox);
    socket_heard(s);
    s->number = ++net->streams;
    snprintf(s->name, sizeof s->name, "s%llu", (unsigned long long)s->number);
    request_init(&s->defaults);
    s->plain = !strcmp(lws_get_protocol(wsi)->name, TEXT_PROTOCOL);
    s->follower = (struct follower){.encoding = s->plain ? encoding_none : encoding_default,
                                    .media = !s->plain,
                                    .outbox = &s->outbox,
                                    .deliver = socket_deliver};
    socket_enter(s, channel_new(net, s->name));
    socket_say(s, message_hello(net, s->name));
    if (guest_enter(net, wsi, &s->guest, &e)) {
        socket_complain(s, &e);
        if (!s->guest.entered)
            socket_dismiss(s, LWS_CLOSE_STATUS_POLICY_VIOLATION, e.code);
    }
    read_query(s);
    return s;
}

void socket_close(struct socket *s) {
    *s->self = s->next;
    if (s->next)
        s->next->self = s->self;
    guest_leave(s->net, &s->guest);
    channel_leave(&s->follower);
    request_free(&s->defaults);
    buf_free(&s->message);
    outbox_close(&s->outbox);
    free(s);
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
    return guest_may(s->net, &s->guest, RIGHT_SPEAK, socket_room(s), e);
}

int socket_may_speak(struct socket *s, struct error *e) {
    if (socket_may_direct(s, e) || guest_ask(s->net, &s->guest, e))
        return -1;
    return s->net->draining ? error_set(e, "stopping", "the server is about to stop") : 0;
}

void socket_speak_request(struct socket *s, const struct speech_request *request) {
    unsigned limit = s->net->options.text_bytes;
    struct error e;
    int refused = socket_may_speak(s, &e);
    if (!refused && request->text_size > limit)
        refused = error_in_field(&e, "text-too-long", "text", "a text may have %u bytes", limit);
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
