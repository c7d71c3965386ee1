/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms over plain HTTP: to say something in one, to silence it, and its events as server-sent events (HTML
 * standard, 9.2). */
#include "server/base/mem.h"
#include "server/net/internal.h"
#include <stdlib.h>
#include <string.h>

struct channel *room_asked(struct exchange *x, int *result) {
    char value[TOKEN_ROOM + 2];
    struct error e;
    const char *name = exchange_query(x, "room", value, sizeof value);
    struct channel *channel = name ? channel_find(exchange_net(x), name) : NULL;
    if (!name)
        error_in_field(&e, "missing-field", "room", "is missing");
    else if (!channel)
        error_in_field(&e, "unknown-room", "room", "nobody is in a room '%s'", name);
    else
        return channel;
    *result = exchange_error(x, name ? 404 : 400, &e);
    return NULL;
}

struct say {
    struct exchange *x;
    struct buf text;
    const char *markup;
};

static int say_body(void *self, const void *data, size_t size) {
    struct say *say = self;
    struct error e;
    unsigned limit = exchange_net(say->x)->options.text_bytes;
    if (exchange_answered(say->x))
        return 0;
    if (say->text.size + size > limit) {
        error_set(&e, "text-too-long", "a text may have %u bytes", limit);
        return exchange_error(say->x, 413, &e);
    }
    buf_add(&say->text, data, size);
    return 0;
}

static int say_end(void *self) {
    struct say *say = self;
    struct speech_request request;
    struct error e;
    int result = 0;
    if (exchange_answered(say->x))
        return 0;
    struct channel *channel = room_asked(say->x, &result);
    if (!channel)
        return result;
    request_init(&request);
    request.markup = mem_strdup(say->markup);
    const char *text = say->text.size ? (const char *)say->text.data : "";
    bool bad =
        request_from_query(&request, exchange_request(say->x), "room", &e) ||
        request_set(&request, "text", (struct request_value){REQUEST_STRING, text, say->text.size, 0}, &e);
    if (!bad)
        stream_speak(channel_stream(channel), &request);
    result = bad ? exchange_error(say->x, 400, &e)
                 : exchange_json(say->x, 202,
                                 json_pack("{ss ss}", "type", "accepted", "room", channel_name(channel)));
    request_free(&request);
    return result;
}

static void say_free(void *self) {
    struct say *say = self;
    buf_free(&say->text);
    free(say);
}

int room_say(struct exchange *x) {
    int result = 0;
    if (!room_asked(x, &result))
        return result;
    const char *markup = post_markup(x, &result);
    if (!markup)
        return result;
    struct say *say = mem_alloc(sizeof *say);
    say->x = x;
    say->markup = markup;
    exchange_set_work(
        x, (struct exchange_work){.body = say_body, .body_end = say_end, .free = say_free, .self = say});
    return 0;
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

struct events {
    struct follower follower;
    struct exchange *x;
};

static void on_delivery(struct follower *f, struct parcel *parcel) {
    struct events *events = (struct events *)f;
    struct buf text = {0};
    if (parcel->media || exchange_unsent(events->x) > exchange_net(events->x)->options.send_bytes)
        return; /* he who does not listen misses something */
    buf_printf(&text, "event: %s\ndata: ", parcel->event);
    buf_add(&text, parcel_body(parcel), parcel->size);
    buf_add(&text, "\n\n", 2);
    exchange_add(events->x, text.data, text.size);
    buf_free(&text);
}

/* A comment from time to time shows both ends that the other is there. */
static void events_beat(void *self) {
    struct events *events = self;
    static const char comment[] = ": still here\n\n";
    if (!exchange_unsent(events->x))
        exchange_add(events->x, comment, strlen(comment));
}

static void events_free(void *self) {
    struct events *events = self;
    channel_leave(&events->follower);
    free(events);
}

int room_events(struct exchange *x) {
    char value[TOKEN_ROOM + 2];
    struct error e;
    const char *name = exchange_query(x, "room", value, sizeof value);
    struct channel *channel = name ? channel_room(exchange_net(x), name, &e)
                                   : (error_in_field(&e, "missing-field", "room", "is missing"), NULL);
    if (!channel)
        return exchange_error(x, 400, &e);
    struct events *events = mem_alloc(sizeof *events);
    events->x = x;
    events->follower.deliver = on_delivery;
    exchange_set_work(
        x, (struct exchange_work){.beat = events_beat, .free = events_free, .self = events, .endless = true});
    if (exchange_begin(x, "text/event-stream"))
        return -1;
    channel_join(channel, &events->follower);
    events_beat(events);
    return 0;
}
