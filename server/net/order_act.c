/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/order_act.h"
#include "server/base/mem.h"
#include "server/net/client_message.h"
#include "server/net/consent.h"
#include "server/net/homes_internal.h"
#include "server/net/notices.h"
#include <string.h>

/* An order while it is done. */
struct acting {
    struct net *net;
    const char *room;
    struct channel *channel; /* NULL: nobody is there */
    const json_t *order, *message;
    const char *by;
    uint64_t abroad, number;
    unsigned status; /* of an answer that is none to an error */
};

static json_t *answer_of(struct acting *a, unsigned status, const char *type) {
    a->status = status;
    return json_pack("{ss ss}", "type", type, "room", a->room);
}

static json_t *accepted(struct acting *a) {
    json_t *answer = answer_of(a, 202, "accepted");
    json_object_set_new(answer, "listeners", json_integer((json_int_t)channel_listeners(a->channel)));
    return answer;
}

static struct stream *stream_of(const struct acting *a) {
    return channel_stream(a->channel);
}

/* Nobody is there: it is kept, where that is wanted. */
static json_t *say_to_nobody(struct net *net, const char *room, const struct speech_request *request,
                             struct error *e) {
    const struct channel *c = channel_find(net, room);
    unsigned seconds = net->options.hold_seconds;
    if (seconds && hold_keep(net, room, request, e))
        return NULL;
    json_t *answer = json_pack("{ss ss si}", "type", "accepted", "room", room, "listeners", 0);
    if (seconds)
        json_object_set_new(answer, "held", json_integer(seconds));
    if (seconds && c && c->home)
        home_keep(c->home, (uint64_t)seconds * 1000);
    return answer;
}

/* What is refused has a number, too, by which its end is told. */
static uint32_t numbered(const struct stream *stream, uint32_t utterance) {
    return utterance ? utterance : stream_number(stream);
}

json_t *order_say(struct net *net, const char *room, const struct speech_request *request,
                  uint32_t *utterance, struct error *e) {
    *utterance = 0;
    struct channel *c = channel_find(net, room);
    if (c && request->mode == SPEAK_QUIET && stream_busy(channel_stream(c)))
        return error_plain(e, ERROR_BUSY), NULL;
    if (!c || !channel_followers(c) || (!channel_listeners(c) && net->options.hold_seconds))
        return say_to_nobody(net, room, request, e);
    int listeners = (int)channel_listeners(c);
    *utterance = numbered(channel_stream(c), stream_speak(channel_stream(c), request));
    return json_pack("{ss ss si}", "type", "accepted", "room", room, "listeners", listeners);
}

static void add_number(json_t *answer, uint32_t utterance) {
    if (answer && utterance)
        json_object_set_new(answer, "utterance", json_integer(utterance));
}

/* -1 with *e. */
static int read_speech(const struct acting *a, struct speech_request *request, struct error *e) {
    request_init(request);
    request->payer = (uint32_t)json_integer_value(json_object_get(a->order, "payer"));
    request->asker = (uint32_t)json_integer_value(json_object_get(a->order, "asker"));
    if (a->net->draining)
        return error_plain(e, ERROR_STOPPING), -1;
    int failed = request_from_json(request, json_object_get(a->order, "request"), e);
    request->abroad = a->abroad;
    request->order = a->number;
    return failed;
}

static json_t *say(struct acting *a, struct error *e) {
    struct speech_request request;
    uint32_t utterance = 0;
    json_t *answer = NULL;
    if (!read_speech(a, &request, e))
        answer = order_say(a->net, a->room, &request, &utterance, e);
    add_number(answer, utterance);
    a->status = 202;
    request_free(&request);
    return answer;
}

static json_t *speak(struct acting *a, struct error *e) {
    struct speech_request request;
    json_t *answer = NULL;
    if (!read_speech(a, &request, e)) {
        answer = accepted(a);
        add_number(answer, numbered(stream_of(a), stream_speak(stream_of(a), &request)));
    }
    request_free(&request);
    return answer;
}

static json_t *play(struct acting *a, struct error *e) {
    const char *name = json_string_value(json_object_get(a->message, "name"));
    struct recording_source source = {0};
    struct speech_request request;
    json_t *answer = NULL;
    request_init(&request);
    if (!client_message_check("play", a->message, e) &&
        !request_from_json(&request, json_object_get(a->order, "request"), e) &&
        !media_source(a->net, &source, name, e)) {
        source.id = request.id ? mem_strdup(request.id) : NULL;
        request.order = a->number;
        uint32_t utterance = numbered(stream_of(a), stream_play(stream_of(a), &source, &request));
        answer = answer_of(a, 202, "accepted");
        add_number(answer, utterance);
    }
    recording_source_free(&source);
    request_free(&request);
    return answer;
}

static json_t *stop(struct acting *a, struct error *e) {
    (void)e;
    stream_stop(stream_of(a));
    return answer_of(a, 200, "stopped");
}

static json_t *pause_it(struct acting *a, struct error *e) {
    (void)e;
    stream_pause(stream_of(a));
    return answer_of(a, 200, "paused");
}

static json_t *resume(struct acting *a, struct error *e) {
    (void)e;
    stream_resume(stream_of(a));
    return answer_of(a, 200, "resumed");
}

static json_t *rate(struct acting *a, struct error *e) {
    if (client_message_check("rate", a->message, e))
        return NULL;
    stream_rate(stream_of(a), json_number_value(json_object_get(a->message, "rate")));
    return accepted(a);
}

static json_t *jump(struct acting *a, struct error *e) {
    const json_t *value = json_object_get(a->message, "mark");
    if (client_message_check("jump", a->message, e))
        return NULL;
    return stream_jump(stream_of(a), json_string_value(value), e) ? NULL : accepted(a);
}

static json_t *cancel(struct acting *a, struct error *e) {
    const char *id = json_string_value(json_object_get(a->message, "id"));
    if (client_message_check("cancel", a->message, e))
        return NULL;
    if (!stream_cancel(stream_of(a), id))
        error_in_field(e, ERROR_UNKNOWN_UTTERANCE, "id", "no utterance '%.64s' is spoken or waits", id);
    else
        return accepted(a);
    return NULL;
}

static json_t *express(struct acting *a, struct error *e) {
    return notice_express(a->channel, a->message, a->by, e) ? NULL : accepted(a);
}

static json_t *choices(struct acting *a, struct error *e) {
    return notice_choices(a->channel, a->message, e) ? NULL : accepted(a);
}

static json_t *choose(struct acting *a, struct error *e) {
    return notice_choose(a->channel, a->message, a->by, e) ? NULL : accepted(a);
}

static json_t *state(struct acting *a, struct error *e) {
    return notice_state(a->channel, a->message, e) ? NULL : accepted(a);
}

static json_t *calibrate(struct acting *a, struct error *e) {
    return notice_calibrate(a->channel, a->message, e) ? NULL : accepted(a);
}

static json_t *consent(struct acting *a, struct error *e) {
    return consent_take(a->channel, a->message, a->by, e) ? NULL : accepted(a);
}

/* NULL with *e. */
static json_t *act(struct acting *a, struct error *e) {
    static const struct {
        const char *type;
        json_t *(*act)(struct acting *a, struct error *e);
    } types[] = {{"speak", speak},     {"play", play},       {"stop", stop},          {"pause", pause_it},
                 {"resume", resume},   {"rate", rate},       {"jump", jump},          {"cancel", cancel},
                 {"express", express}, {"choices", choices}, {"choose", choose},      {"state", state},
                 {"consent", consent}, {"say", say},         {"calibrate", calibrate}};
    const char *type = json_string_value(json_object_get(a->order, "type"));
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++) {
        if (strcmp(types[i].type, type) != 0)
            continue;
        if (a->channel || types[i].act == say)
            return types[i].act(a, e);
        error_in_field(e, ERROR_UNKNOWN_ROOM, "room", "nobody is in a room '%s'", a->room);
        return NULL;
    }
    error_plain(e, ERROR_UNKNOWN_TYPE);
    return NULL;
}

json_t *order_act(struct net *net, const char *room, const json_t *order, uint64_t abroad, uint64_t number,
                  unsigned *status) {
    const char *by = json_string_value(json_object_get(order, "by"));
    struct channel *c = channel_find(net, room);
    struct acting a = {.net = net,
                       .room = room,
                       .channel = c && channel_followers(c) ? c : NULL,
                       .order = order,
                       .message = json_object_get(order, "message"),
                       .abroad = abroad,
                       .number = number,
                       .by = by ? by : ""};
    struct error e;
    json_t *answer = act(&a, &e);
    *status = answer ? a.status : (unsigned)error_status(e.code);
    return answer ? answer : message_error(&e);
}
