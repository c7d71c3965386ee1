/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms over plain HTTP: to say something in one, to silence it. */
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include "server/net/order_act.h"
#include "server/net/post_text.h"
#include "server/net/room_order.h"
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
        stream_refuse(channel_stream(channel), id, 0, e);
}

struct say {
    struct post_text text;
    struct room_order waits;
};

static int say_end(void *self) {
    struct say *say = self;
    struct exchange *x = say->text.x;
    struct speech_request request;
    struct error e;
    json_t *answer = NULL, *wanted;
    uint32_t utterance;
    request_init(&request);
    int failed = post_text_request(&say->text, &request, &e);
    if (!failed && room_order_needed(x)) {
        json_int_t payer = request.payer, asker = request.asker;
        wanted = request_to_json(&request);
        request_free(&request);
        if (wanted)
            return room_order_give(
                &say->waits, x,
                json_pack("{ss so sI sI}", "type", "say", "request", wanted, "payer", payer, "asker", asker));
        return error_plain(&e, ERROR_BAD_UTF8), exchange_error(x, &e);
    }
    if (!failed)
        answer =
            order_say(exchange_net(x), http_query(exchange_request(x), "room"), &request, &utterance, &e);
    request_free(&request);
    return answer ? exchange_json(x, 202, answer) : exchange_error(x, &e);
}

static void say_free(void *self) {
    struct say *say = self;
    room_order_forget(&say->waits);
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

static int direct(struct exchange *x, const char *type, void (*act)(struct stream *stream),
                  const char *done) {
    int result = 0;
    if (room_order_needed(x))
        return room_order(x, json_pack("{ss}", "type", type));
    struct channel *channel = room_asked(x, &result);
    if (!channel)
        return result;
    act(channel_stream(channel));
    return exchange_json(x, 200, json_pack("{ss ss}", "type", done, "room", channel_name(channel)));
}

int room_stop(struct exchange *x) {
    return direct(x, "stop", stream_stop, "stopped");
}

int room_pause(struct exchange *x) {
    return direct(x, "pause", stream_pause, "paused");
}

int room_resume(struct exchange *x) {
    return direct(x, "resume", stream_resume, "resumed");
}
