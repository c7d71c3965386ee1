/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms over plain HTTP: to say something in one, to silence it. */
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include "server/net/post_text.h"
#include <stdlib.h>
#include <string.h>

struct channel *room_asked(struct exchange *x, int *result) {
    char value[TOKEN_ROOM + 2];
    struct error e;
    const char *name = exchange_query(x, "room", value, sizeof value);
    struct channel *channel = name ? channel_find(exchange_net(x), name) : NULL;
    if (!name)
        error_plain_in_field(&e, ERROR_MISSING_FIELD, "room");
    else if (!channel)
        error_in_field(&e, ERROR_UNKNOWN_ROOM, "room", "nobody is in a room '%s'", name);
    else
        return channel;
    *result = exchange_error(x, &e);
    return NULL;
}

void room_unheard(struct net *net, const char *room, const char *id, const struct error *e) {
    struct channel *channel = channel_find(net, room);
    if (channel)
        stream_refuse(channel_stream(channel), id, e);
}

struct say {
    struct post_text text;
};

/* Nobody is there: it is kept, where that is wanted. */
static int say_to_nobody(struct exchange *x, const char *room, const struct speech_request *request) {
    struct net *net = exchange_net(x);
    json_t *answer = json_pack("{ss ss si}", "type", "accepted", "room", room, "listeners", 0);
    struct error e;
    if (!net->options.hold_seconds)
        return exchange_json(x, 202, answer);
    json_object_set_new(answer, "held", json_integer(net->options.hold_seconds));
    if (!hold_keep(net, room, request, &e))
        return exchange_json(x, 202, answer);
    json_decref(answer);
    return exchange_error(x, &e);
}

static int say_end(void *self) {
    struct say *say = self;
    struct exchange *x = say->text.x;
    struct speech_request request;
    struct error e;
    const char *room = http_query(exchange_request(x), "room");
    int result;
    request_init(&request);
    struct channel *channel = channel_find(exchange_net(x), room);
    if (post_text_request(&say->text, &request, &e)) {
        result = exchange_error(x, &e);
    } else if (channel && request.mode == SPEAK_QUIET && stream_busy(channel_stream(channel))) {
        error_plain(&e, ERROR_BUSY);
        result = exchange_error(x, &e);
    } else if (channel && (channel_listeners(channel) || !exchange_net(x)->options.hold_seconds)) {
        int listeners = (int)channel_listeners(channel);
        stream_speak(channel_stream(channel), &request);
        result = exchange_json(x, 202,
                               json_pack("{ss ss si}", "type", "accepted", "room", channel_name(channel),
                                         "listeners", listeners));
    } else {
        result = say_to_nobody(x, room, &request);
    }
    request_free(&request);
    return result;
}

static void say_free(void *self) {
    struct say *say = self;
    post_text_free(&say->text);
    free(say);
}

static const struct members say_members = {.speech = true};

int room_say(struct exchange *x) {
    int result = 0;
    const char *room = http_query(exchange_request(x), "room");
    struct error e;
    if (!room)
        return error_plain_in_field(&e, ERROR_MISSING_FIELD, "room"), exchange_error(x, &e);
    if (channel_check_name(room, &e))
        return exchange_error(x, &e);
    if (http_query(exchange_request(x), "open"))
        return room_write(x);
    struct say *say = mem_alloc(sizeof *say);
    exchange_set_work(x, (struct exchange_work){.body_end = say_end, .free = say_free, .self = say});
    post_text_begin(&say->text, x, &say_members, &result);
    return result;
}

static int direct(struct exchange *x, void (*act)(struct stream *stream), const char *done) {
    int result = 0;
    struct channel *channel = room_asked(x, &result);
    if (!channel)
        return result;
    act(channel_stream(channel));
    return exchange_json(x, 200, json_pack("{ss ss}", "type", done, "room", channel_name(channel)));
}

int room_stop(struct exchange *x) {
    return direct(x, stream_stop, "stopped");
}

int room_pause(struct exchange *x) {
    return direct(x, stream_pause, "paused");
}

int room_resume(struct exchange *x) {
    return direct(x, stream_resume, "resumed");
}
