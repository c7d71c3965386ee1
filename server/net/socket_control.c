/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages that direct what is said, and how the face lives. */
#include "server/base/mem.h"
#include "server/net/client_message.h"
#include "server/net/notices.h"
#include "server/net/socket_internal.h"

/* What needs nothing but the right. */
static void direct(struct socket *s, void (*act)(struct stream *stream)) {
    struct error e;
    if (socket_may_direct(s, &e))
        socket_complain(s, &e);
    else
        act(socket_stream(s));
}

void control_stop(struct socket *s, const json_t *message) {
    (void)message;
    direct(s, stream_stop);
}

void control_pause(struct socket *s, const json_t *message) {
    (void)message;
    direct(s, stream_pause);
}

void control_resume(struct socket *s, const json_t *message) {
    (void)message;
    direct(s, stream_resume);
}

void control_rate(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || client_message_check("rate", message, &e))
        socket_complain(s, &e);
    else
        stream_rate(socket_stream(s), json_number_value(json_object_get(message, "rate")));
}

static const char *string_of(const json_t *message, const char *name) {
    return json_string_value(json_object_get(message, name));
}

void control_jump(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || client_message_check("jump", message, &e) ||
        stream_jump(socket_stream(s), string_of(message, "mark"), &e))
        socket_complain(s, &e);
}

void control_play(struct socket *s, const json_t *message) {
    struct speech_request request;
    struct recording_source source = {0};
    struct error e;
    request_init(&request);
    int wrong = client_message_request("play", message, &request, &e) || socket_may_speak(s, &e) ||
                client_message_check("play", message, &e) ||
                media_source(s->net, &source, string_of(message, "name"), &e);
    if (wrong) {
        socket_refuse(s, request.id, &e);
        recording_source_free(&source);
    } else {
        source.id = request.id ? mem_strdup(request.id) : NULL;
        stream_play(socket_stream(s), &source, &request);
    }
    request_free(&request);
}

void control_idle(struct socket *s, const json_t *message) {
    struct idle_options options;
    struct error e;
    bool on;
    if (live_idle(message, &s->defaults, s->number, &options, &on, &e))
        socket_complain(s, &e);
    else if (!s->plain)
        channel_idle(&s->follower, on ? &options : NULL);
}

void control_express(struct socket *s, const json_t *message) {
    struct error e;
    if (socket_may_direct(s, &e) || notice_express(s->follower.channel, message, socket_called(s), &e))
        socket_complain(s, &e);
}
