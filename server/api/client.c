/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket client: its lifecycle, its room and the media it receives. */
#include "server/api/client_internal.h"
#include "server/base/mem.h"
#include "server/http/http_request.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Sending */

static void send_text(struct client *c, const struct buf *text) {
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text->data, text->size);
    websocket_send(c->ws, message);
    queued_message_release(message);
}

void client_say(struct client *c, json_t *object) {
    struct buf text = {0};
    if (c->plain) {
        text_line(object, &text);
        json_decref(object);
    } else {
        json_write(&text, object);
    }
    if (text.size)
        send_text(c, &text);
    buf_free(&text);
}

void client_complain(struct client *c, const struct error *e) {
    json_t *error = error_json(e);
    if (c->asked)
        json_object_set_new(error, "id", json_string(c->asked));
    client_say(c, error);
}

static void client_warn(void *client, const struct error *e) {
    client_say(client, warning_json(e));
}

/* Reports a refused request to this client only, even in a room. */
void client_refuse(struct client *c, const char *id, const struct error *e) {
    if (!client_room(c)) {
        stream_refuse(client_stream(c), id, 0, e);
        return;
    }
    json_t *error = error_json(e), *end = json_pack("{ss ss}", "type", "end", "reason", "failed");
    if (id) {
        json_object_set_new(error, "id", json_string(id));
        json_object_set_new(end, "id", json_string(id));
    }
    client_say(c, error);
    client_say(c, end);
}

static struct client *client_of(struct follower *f) {
    return (struct client *)((char *)f - offsetof(struct client, follower));
}

/* In a room, a client that is too slow skips to the live edge. On its own stream, the stream waits for it. */
static void deliver_one(struct client *c, struct queued_message *message) {
    struct follower *f = &c->follower;
    const struct api_options *options = &c->api->options;
    if (c->plain) {
        if (message->line)
            websocket_send(c->ws, message->line);
        return;
    }
    struct message_queue *queue = websocket_queue(c->ws);
    bool full = queue->unsent > options->http.send_bytes ||
                message_queue_age(queue, message->born) > (uint64_t)options->lag_seconds * 1000;
    if (message->media && f->waits)
        return; /* media before this one were dropped */
    if (!message->media || !full || !channel_is_room(f->channel)) {
        websocket_send(c->ws, message);
        return;
    }
    message_queue_drop_media(queue);
    f->waits = true;
    if (!f->lagging)
        client_say(c, json_pack("{ss ss ss}", "type", "warning", "code", error_name(ERROR_SKIPPED), "message",
                                "media were dropped: the client reads too slowly"));
    f->lagging = true;
}

static void deliver(struct follower *f, struct queued_message *const *messages, size_t count) {
    struct client *c = client_of(f);
    for (size_t i = c->plain ? 0 : websocket_send_now(c->ws, messages, count); i < count; i++)
        deliver_one(c, messages[i]);
}

/* Sends the next part of the model; called again when it has been sent. */
static void push_model_part(struct client *c) {
    const struct model *m = c->model;
    const struct model_part *part = &m->parts[c->model_part];
    struct buf text = {0};
    json_write(&text, json_pack("{ss ss ss si si ss ss}", "type", "model", "name", m->name, "hash",
                                m->asset->hash, "index", (int)c->model_part, "count", (int)m->part_count,
                                "kind", part->kind, "part", part->name));
    text.size--; /* drop the closing brace: more members follow */
    buf_printf(&text, ",\"data\":");
    buf_add(&text, part->json, strlen(part->json));
    buf_add(&text, "}", 1);
    if (++c->model_part == m->part_count) /* before sending, which may already ask for the next part */
        c->model = NULL;
    send_text(c, &text);
    buf_free(&text);
}

void client_send_model(struct client *c, const json_t *message) {
    const char *name = json_string_value(json_object_get(message, "name"));
    const struct heads *heads = &c->api->heads;
    struct error e;
    c->model = name ? heads_find(heads, name) : heads->count ? &heads->list[0] : NULL;
    c->model_part = 0;
    if (c->model) {
        push_model_part(c);
        return;
    }
    heads_unknown(heads, name ? name : "", "name", &e);
    client_complain(c, &e);
}

/* Rooms */

struct stream *client_stream(const struct client *c) {
    return channel_stream(c->follower.channel);
}

const char *client_room(const struct client *c) {
    const struct channel *channel = c->follower.channel;
    return channel_is_room(channel) ? channel_name(channel) : NULL;
}

const char *client_called(const struct client *c) {
    const char *subject = c->principal.token.subject;
    return *subject ? subject : *c->called ? c->called : c->name;
}

static void enter(struct client *c, struct channel *channel) {
    c->follower.idle = false;
    channel_join(channel, &c->follower);
}

/* Sets how the room lists this observer: its name, and whether it may speak. */
static void name_observer(struct client *c, const char *room) {
    struct error ignored;
    c->follower.observer = client_called(c);
    c->follower.directs = !principal_may(c->api, &c->principal, RIGHT_SPEAK, room, &ignored);
}

static int join(struct client *c, const char *room, bool watch, const char *called, struct error *e) {
    if (principal_may(c->api, &c->principal, client_message_right("join"), room, e))
        return -1;
    struct channel *channel = channel_room(c->api->rooms, room, principal_quota_key(&c->principal), e);
    if (!channel)
        return -1;
    snprintf(c->called, sizeof c->called, "%s", called ? called : "");
    name_observer(c, room);
    if (channel == c->follower.channel) {
        bool known = watch || c->follower.watches;
        channel_watch(&c->follower, watch);
        if (known)
            observers_tell(channel);
        return 0;
    }
    open_texts_leave(c);
    observers_leave(&c->follower);
    c->follower.watches = watch;
    client_say(c, json_pack("{ss ss si sb}", "type", "joined", "room", room, "followers",
                            (int)channel_followers(channel) + 1, "may_speak", c->follower.directs));
    enter(c, channel);
    if (watch)
        observers_tell(channel);
    return 0;
}

void client_join(struct client *c, const json_t *message) {
    const char *room = json_string_value(json_object_get(message, "room"));
    const char *called = json_string_value(json_object_get(message, "as"));
    struct error e;
    if (join(c, room, json_is_true(json_object_get(message, "watch")), called, &e))
        client_complain(c, &e);
}

static void leave(struct client *c) {
    open_texts_leave(c);
    client_say(c, json_pack("{ss ss}", "type", "left", "room", client_room(c)));
    observers_leave(&c->follower);
    c->follower.watches = false;
    enter(c, channel_new(c->api->rooms, c->name));
}

void client_leave_room(struct client *c, const json_t *message) {
    (void)message;
    if (client_room(c))
        leave(c);
}

void client_authorize(struct client *c, const json_t *message) {
    const char *token = json_string_value(json_object_get(message, "token"));
    struct error e;
    if (principal_show(c->api, &c->principal, token, &e)) {
        client_complain(c, &e);
        return;
    }
    client_say(c, json_pack("{ss ss}", "type", "authorized", "subject", c->principal.token.subject));
    if (!client_room(c))
        return;
    name_observer(c, client_room(c));
    if (c->follower.watches)
        observers_tell(c->follower.channel);
}

/* The flag holds wherever the client goes; who is sent what: notices.h. */
void client_overhear(struct client *c, const json_t *message) {
    const json_t *on = json_object_get(message, "on");
    struct error e;
    if (principal_may(c->api, &c->principal, client_message_right("overhear"), client_room(c), &e))
        client_complain(c, &e);
    else
        c->follower.overhears = !on || json_is_true(on);
}

void client_pong(struct client *c, const json_t *message) {
    json_t *answer = json_pack("{ss}", "type", "pong");
    json_object_set(answer, "id", json_object_get(message, "id"));
    client_say(c, answer);
}

/* Media */

/* Requested encodings of media and events; NULL leaves one unchanged. */
struct media_wish {
    const char *audio, *fap, *events, *kilobits;
};

/* -1 with *e. */
static int set_media(struct client *c, const struct media_wish *wish, struct error *e) {
    struct encoding encoding = c->follower.encoding;
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
        return error_in_field(e, ERROR_UNKNOWN_CODEC, "events", "unknown form of events '%s'", wish->events);
    encoding.packed = packed;
    if (!encoding_possible(&encoding))
        return error_in_field(e, ERROR_UNKNOWN_CODEC, "fap",
                              "plain FAPs cannot be combined with Opus: request fapc or pcm");
    channel_want(&c->follower, &encoding);
    return 0;
}

void client_choose_media(struct client *c, const json_t *message) {
    const json_t *kilobits = json_object_get(message, "kilobits"),
                 *blocked = json_object_get(message, "blocked");
    char number[32];
    struct media_wish wish = {json_string_value(json_object_get(message, "audio")),
                              json_string_value(json_object_get(message, "fap")),
                              json_string_value(json_object_get(message, "events")), NULL};
    struct error e;
    if (blocked)
        c->follower.blocked = json_is_true(blocked);
    if (kilobits) {
        snprintf(number, sizeof number, "%.12g", json_number_value(kilobits));
        wish.kilobits = number;
    }
    if (set_media(c, &wish, &e))
        client_complain(c, &e);
}

void client_idle(struct client *c, const json_t *message) {
    struct idle_options options;
    struct error e;
    bool on;
    if (idle_from_json(message, &c->defaults, c->number, &options, &on, &e))
        client_complain(c, &e);
    else if (!c->plain)
        channel_idle(&c->follower, on ? &options : NULL);
}

/* Lifecycle */

static void on_message(void *owner, struct buf *message, bool binary, bool too_long) {
    client_hear(owner, message, binary, too_long);
}

static void on_fault(void *owner, const struct error *e) {
    client_complain(owner, e);
}

/* A client of the text protocol that has closed its side still receives the rest of its speech. */
static bool on_lingers(void *owner) {
    const struct client *c = owner;
    return c->plain && !client_room(c) && stream_busy(client_stream(c));
}

static void on_drained(void *owner) {
    struct client *c = owner;
    if (c->follower.lagging) {
        c->follower.lagging = false;
        channel_resume(&c->follower);
    }
    if (c->model)
        push_model_part(c);
}

static void on_free(void *owner) {
    struct client *c = owner;
    *c->self = c->next;
    if (c->next)
        c->next->self = c->self;
    open_texts_leave(c);
    observers_leave(&c->follower);
    client_forget_reading(c);
    request_free(&c->defaults);
    free(c);
}

/* Applies the members of the address, including the defaults of requests. */
static void read_query(struct client *c, const struct http_request *from) {
    static const char *const more[] = {"room",     "audio", "fap", "events",
                                       "kilobits", "watch", "key", NULL}; /* the last is for proxies */
    static const struct members known = {.speech = true, .more = more};
    const struct media_wish wish = {http_query(from, "audio"), http_query(from, "fap"),
                                    http_query(from, "events"), http_query(from, "kilobits")};
    const char *room = http_query(from, "room");
    struct error e;
    query_check(from, &known, false, client_warn, c);
    if (request_from_query(&c->defaults, from, NULL, &e) || set_media(c, &wish, &e))
        client_complain(c, &e);
    c->defaults.open = false; /* each utterance decides that for itself */
    bool watch;
    if (query_flag(http_query(from, "watch"), "watch", &watch, &e) ||
        (room && join(c, room, watch, NULL, &e)))
        client_complain(c, &e);
}

static void open_client(struct api *api, struct websocket *ws, const struct http_request *request,
                        bool plain) {
    static const struct websocket_calls calls = {on_message, on_fault, on_lingers, on_drained, on_free};
    struct client *c = mem_alloc(sizeof *c);
    struct error e = {0};
    *c = (struct client){.api = api, .ws = ws, .next = api->clients, .self = &api->clients, .plain = plain};
    if (c->next)
        c->next->self = &c->next;
    api->clients = c;
    c->number = ++api->streams;
    snprintf(c->name, sizeof c->name, "s%llu", (unsigned long long)c->number);
    request_init(&c->defaults);
    c->follower = (struct follower){.encoding = plain ? encoding_none : encoding_default,
                                    .media = !plain,
                                    .lines = plain,
                                    .queue = websocket_queue(ws),
                                    .deliver = deliver};
    enter(c, channel_new(api->rooms, c->name));
    websocket_use(ws, &calls, c, c->name);
    client_say(c, message_hello(api, c->name));
    if (principal_enter(api, request, &c->principal, &e))
        client_complain(c, &e);
    read_query(c, request);
}

static void refuse(struct exchange *x, enum error_code code, const char *why) {
    struct error e;
    error_set(&e, code, "%s", why);
    exchange_error(x, &e);
}

void client_accept(struct exchange *x) {
    static const char *const protocols[] = {"faccia.v1", TEXT_PROTOCOL, NULL};
    struct api *api = exchange_api(x);
    const struct http_request *r = exchange_request(x);
    const char *protocol;
    struct error e;
    if (r->method != HTTP_GET || !r->minor) {
        refuse(x, ERROR_BAD_HANDSHAKE, "a WebSocket is opened with an HTTP/1.1 GET");
    } else if (principal_check_host(api, r, &e)) {
        exchange_error(x, &e);
    } else if (strcmp(r->path, "/v1/stream")) {
        refuse(x, ERROR_NOT_FOUND, "there is no WebSocket at this address");
    } else if (!principal_origin_allowed(api, r)) {
        metrics_add(api->pipeline->metrics, METRIC_REFUSED_ORIGIN, 1);
        refuse(x, ERROR_FORBIDDEN_ORIGIN, "pages of that origin may not use this server");
    } else if (api->draining) {
        metrics_add(api->pipeline->metrics, METRIC_REFUSED_LIMIT, 1);
        refuse(x, ERROR_STOPPING, "the server is shutting down");
    } else {
        struct websocket *ws = websocket_accept(x, protocols, &protocol);
        if (ws)
            open_client(api, ws, r, protocol == protocols[1]);
    }
}

bool clients_busy(const struct api *api) {
    for (const struct client *c = api->clients; c; c = c->next)
        if (!websocket_all_sent(c->ws) || stream_busy(client_stream(c)) ||
            channel_pending(c->follower.channel))
            return true;
    return false;
}

void clients_dismiss(struct api *api, const char *reason) {
    for (struct client *c = api->clients; c; c = c->next)
        websocket_close(c->ws, WEBSOCKET_GOING_AWAY, reason);
}

/* Stops a client's own stream. In a room others may be speaking, so the client is removed from it. */
void clients_revoke(struct api *api) {
    struct error e;
    error_plain(&e, ERROR_REVOKED_TOKEN);
    for (struct client *c = api->clients; c; c = c->next) {
        if (!principal_revoke(api, &c->principal))
            continue;
        client_complain(c, &e);
        client_ears_leave(c);
        if (client_room(c))
            leave(c);
        else
            stream_stop(client_stream(c));
    }
}
