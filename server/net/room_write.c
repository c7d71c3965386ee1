/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that is written to a room over HTTP: what has come of the body is spoken while the rest is written.
 */
#include "server/base/mem.h"
#include "server/net/net_internal.h"
#include "server/net/post_text.h"
#include <stdlib.h>

struct writing_post {
    struct post_text text;
    uint64_t channel; /* its number: the room may go, and another of its name come */
    uint32_t utterance;
    int listeners;
};

/* The room's stream while it is there. */
static struct stream *stream_of(const struct writing_post *p) {
    const char *room = http_query(exchange_request(p->text.x), "room");
    struct channel *channel = channel_find(exchange_net(p->text.x), room);
    return channel && channel_number(channel) == p->channel ? channel_stream(channel) : NULL;
}

static void on_body(void *self, const void *data, size_t size) {
    struct writing_post *p = self;
    struct stream *stream = stream_of(p);
    struct error e;
    if (stream &&
        stream_write(stream, p->utterance, data, size, exchange_net(p->text.x)->options.text_bytes, &e)) {
        stream_close(stream, p->utterance, &e);
        p->utterance = 0;
        exchange_error(p->text.x, &e);
    }
}

static int on_body_end(void *self) {
    struct writing_post *p = self;
    struct stream *stream = stream_of(p);
    if (stream)
        stream_close(stream, p->utterance, NULL);
    p->utterance = 0;
    return exchange_json(p->text.x, 202,
                         json_pack("{ss ss si}", "type", "accepted", "room",
                                   http_query(exchange_request(p->text.x), "room"), "listeners",
                                   p->listeners));
}

static void on_free(void *self) {
    struct writing_post *p = self;
    struct stream *stream = p->utterance ? stream_of(p) : NULL;
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "who wrote it has gone: the text is taken as it is");
    if (stream)
        stream_close(stream, p->utterance, &e);
    post_text_free(&p->text);
    free(p);
}

static const struct members write_members = {.speech = true};

static int speak(struct writing_post *p, struct speech_request *request, struct error *e) {
    struct exchange *x = p->text.x;
    const char *room = http_query(exchange_request(x), "room");
    if (p->text.json)
        return error_in_field(e, ERROR_BAD_FIELD, "open",
                              "a text that is written comes as it is, not as JSON");
    struct channel *channel = channel_find(exchange_net(x), room);
    if (channel && channel_elsewhere(channel))
        return error_set(e, ERROR_ROOM_AWAY,
                         "another daemon speaks in this room: a text that is being written goes to that one");
    if (!channel)
        return error_in_field(e, ERROR_UNKNOWN_ROOM, "room", "nobody is in a room '%s'", room);
    if (post_text_request(&p->text, request, e))
        return -1;
    if (!request->open)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "must be true where it is given");
    p->channel = channel_number(channel);
    p->listeners = (int)channel_listeners(channel);
    p->utterance = stream_speak(channel_stream(channel), request, NULL);
    return 0;
}

int room_write(struct exchange *x) {
    int result = 0;
    struct speech_request request;
    struct error e = {0};
    struct writing_post *p = mem_alloc(sizeof *p);
    exchange_set_work(
        x, (struct exchange_work){.body = on_body, .body_end = on_body_end, .free = on_free, .self = p});
    if (post_text_begin(&p->text, x, &write_members, &result))
        return result;
    request_init(&request);
    if (speak(p, &request, &e))
        result = exchange_error(x, &e);
    request_free(&request);
    return result;
}
