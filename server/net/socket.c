/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket client: its messages in, and the queue of what goes out to it. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/socket_parts.h"
#include <stdlib.h>
#include <string.h>

/* So long a client may take to answer a goodbye. */
enum { GOODBYE_SECONDS = 2 };

/* libwebsockets cannot take a timer back, so this one is set again while there is something to watch. */
static void watch_stall(struct socket *s) {
    if (!s->watching)
        lws_set_timer_usecs(s->wsi, (lws_usec_t)s->net->options.stall_seconds * LWS_US_PER_SEC);
    s->watching = true;
}

int socket_timer(struct socket *s) {
    uint64_t still = uv_now(s->net->studio->loop) - s->progress;
    s->watching = false;
    if (outbox_empty(&s->outbox))
        return 0;
    if (still >= (uint64_t)s->net->options.stall_seconds * 1000) {
        metrics_add(s->net->studio->metrics, METRIC_TOO_SLOW, 1);
        log_info("%s takes nothing: closed (too-slow)", s->name);
        return -1;
    }
    watch_stall(s);
    return 0;
}

static void dismiss(struct socket *s, enum lws_close_status status, const char *reason) {
    if (s->doomed)
        return;
    s->doomed = reason;
    s->doom = status;
    lws_callback_on_writable(s->wsi);
}

static void enqueue(struct socket *s, struct parcel *parcel) {
    const struct net_options *options = &s->net->options;
    if (outbox_empty(&s->outbox)) {
        s->progress = uv_now(s->net->studio->loop);
        watch_stall(s);
    }
    outbox_push(&s->outbox, parcel);
    if (!s->deaf && s->outbox.unsent > options->send_bytes) {
        s->deaf = true;
        lws_rx_flow_control(s->wsi, 0);
    }
    if (s->outbox.unsent > options->send_bytes_max && !s->doomed) {
        metrics_add(s->net->studio->metrics, METRIC_TOO_SLOW, 1);
        dismiss(s, LWS_CLOSE_STATUS_POLICY_VIOLATION, "too-slow");
    }
    lws_callback_on_writable(s->wsi);
}

/* One who types gets lines. */
static void push(struct socket *s, struct parcel *parcel) {
    struct buf line = {0};
    if (!s->plain) {
        enqueue(s, parcel);
        return;
    }
    text_line((const char *)parcel_body(parcel), parcel->size, &line);
    if (line.size) {
        struct parcel *said = parcel_new(LWS_WRITE_TEXT, line.data, line.size);
        enqueue(s, said);
        parcel_release(said);
    }
    buf_free(&line);
}

static void push_text(struct socket *s, const struct buf *text) {
    struct parcel *parcel = parcel_new(LWS_WRITE_TEXT, text->data, text->size);
    push(s, parcel);
    parcel_release(parcel);
}

void socket_say(struct socket *s, json_t *object) {
    struct buf text = {0};
    message_write(&text, object);
    push_text(s, &text);
    buf_free(&text);
}

void socket_complain(struct socket *s, const struct error *e) {
    socket_say(s, message_error(e));
}

static struct socket *socket_of(struct follower *f) {
    return (struct socket *)((char *)f - offsetof(struct socket, follower));
}

/* In a room, one who is too slow is moved on to the live edge; on a stream of his own it waits for him. */
static void on_delivery(struct follower *f, struct parcel *parcel) {
    struct socket *s = socket_of(f);
    const struct net_options *options = &s->net->options;
    bool full = s->outbox.unsent > options->send_bytes ||
                outbox_age(&s->outbox, parcel->born) > (uint64_t)options->lag_seconds * 1000;
    if (!parcel->media || !full || !channel_is_room(f->channel)) {
        push(s, parcel);
        return;
    }
    outbox_drop_media(&s->outbox);
    f->waits = true;
    if (!f->lagging)
        socket_say(s, json_pack("{ss ss ss}", "type", "warning", "code", "skipped", "message",
                                "media were left out: they came faster than they were taken"));
    f->lagging = true;
}

static void enter(struct socket *s, struct channel *channel) {
    s->follower.idle = false;
    channel_join(channel, &s->follower);
}

struct stream *socket_stream(const struct socket *s) {
    return channel_stream(s->follower.channel);
}

/* The room that he is in, or NULL. */
static const char *room_of(const struct socket *s) {
    const struct channel *c = s->follower.channel;
    return channel_is_room(c) ? channel_name(c) : NULL;
}

static int join(struct socket *s, const char *room, struct error *e) {
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
    enter(s, channel);
    return 0;
}

static int set_media(struct socket *s, const char *audio, const char *fap, struct error *e) {
    struct encoding encoding = s->follower.encoding;
    int codec;
    if (audio && (codec = encoding_audio(audio)) < 0)
        return error_in_field(e, "unknown-codec", "audio", "no audio codec '%s'", audio);
    if (audio)
        encoding.audio = (uint8_t)codec;
    if (fap && (codec = encoding_fap(fap)) < 0)
        return error_in_field(e, "unknown-codec", "fap", "no FAP codec '%s'", fap);
    if (fap)
        encoding.fap = (uint8_t)codec;
    if (!encoding_possible(&encoding))
        return error_in_field(e, "unknown-codec", "fap",
                              "plain FAPs do not go with Opus: ask for fba, or for pcm");
    channel_want(&s->follower, &encoding);
    return 0;
}

/* What the address asks for, besides the defaults of requests. */
static void read_query(struct socket *s) {
    char room[TOKEN_ROOM + 2], audio[32], fap[32];
    struct error e;
    const char *in = lws_get_urlarg_by_name(s->wsi, "room=", room, sizeof room);
    if (request_from_query(&s->defaults, s->wsi, NULL, &e) ||
        set_media(s, lws_get_urlarg_by_name(s->wsi, "audio=", audio, sizeof audio),
                  lws_get_urlarg_by_name(s->wsi, "fap=", fap, sizeof fap), &e))
        socket_complain(s, &e);
    if (in && join(s, in, &e))
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
    s->number = ++net->streams;
    snprintf(s->name, sizeof s->name, "s%llu", (unsigned long long)s->number);
    request_init(&s->defaults);
    s->plain = !strcmp(lws_get_protocol(wsi)->name, TEXT_PROTOCOL);
    s->follower = (struct follower){.encoding = s->plain ? encoding_none : encoding_default,
                                    .media = !s->plain,
                                    .outbox = &s->outbox,
                                    .deliver = on_delivery};
    enter(s, channel_new(net, s->name));
    socket_say(s, message_hello(net, s->name));
    if (guest_enter(net, wsi, &s->guest, &e)) {
        socket_complain(s, &e);
        if (!s->guest.entered)
            dismiss(s, LWS_CLOSE_STATUS_POLICY_VIOLATION, e.code);
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
    if (!room_of(s)) {
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

/* Whether he may have the stream do something. */
int socket_may_direct(struct socket *s, struct error *e) {
    return guest_may(s->net, &s->guest, RIGHT_SPEAK, room_of(s), e);
}

int socket_may_speak(struct socket *s, struct error *e) {
    if (socket_may_direct(s, e) || guest_ask(s->net, &s->guest, e))
        return -1;
    return s->net->draining ? error_set(e, "stopping", "the server is about to stop") : 0;
}

static void speak(struct socket *s, const struct speech_request *request) {
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

static void speak_json(struct socket *s, const json_t *message) {
    struct speech_request request;
    struct error e = {0};
    request_copy(&request, &s->defaults);
    if (request_from_json(&request, message, &e))
        socket_refuse(s, request.id, &e);
    else
        speak(s, &request);
    request_free(&request);
}

void socket_speak(struct socket *s, const char *text, size_t size) {
    struct speech_request request;
    struct error e;
    request_copy(&request, &s->defaults);
    request_set(&request, "text", (struct request_value){REQUEST_STRING, text, size, 0}, &e);
    speak(s, &request);
    request_free(&request);
}

/* The next part goes out when the one before has left. */
static void push_model_part(struct socket *s) {
    const struct model *m = s->model;
    const struct model_part *part = &m->parts[s->model_part];
    struct buf text = {0};
    message_write(&text, json_pack("{ss ss ss si si ss ss}", "type", "model", "name", m->name, "hash",
                                   m->asset->hash, "index", (int)s->model_part, "count", (int)m->part_count,
                                   "kind", part->kind, "part", part->name));
    text.size--; /* the object goes on */
    buf_printf(&text, ",\"data\":");
    buf_add(&text, part->json, strlen(part->json));
    buf_add(&text, "}", 1);
    push_text(s, &text);
    buf_free(&text);
    if (++s->model_part == m->part_count)
        s->model = NULL;
}

static void send_model(struct socket *s, const json_t *message) {
    const char *name = json_string_value(json_object_get(message, "name"));
    const struct assets *assets = &s->net->assets;
    struct error e;
    s->model = name ? assets_model(assets, name) : assets->model_count ? &assets->models[0] : NULL;
    s->model_part = 0;
    if (s->model) {
        push_model_part(s);
    } else {
        error_in_field(&e, "unknown-model", "name", "no model '%s'", name ? name : "");
        socket_complain(s, &e);
    }
}

static void pong(struct socket *s, const json_t *message) {
    json_t *answer = json_pack("{ss}", "type", "pong");
    json_object_set(answer, "id", json_object_get(message, "id"));
    socket_say(s, answer);
}

static void join_room(struct socket *s, const json_t *message) {
    const char *room = json_string_value(json_object_get(message, "room"));
    struct error e;
    if (room ? join(s, room, &e) : error_in_field(&e, "missing-field", "room", "is missing"))
        socket_complain(s, &e);
}

static void leave_room(struct socket *s, const json_t *message) {
    (void)message;
    if (!room_of(s))
        return;
    socket_say(s, json_pack("{ss ss}", "type", "left", "room", room_of(s)));
    channel_leave(&s->follower);
    enter(s, channel_new(s->net, s->name));
}

static void choose_media(struct socket *s, const json_t *message) {
    struct error e;
    if (set_media(s, json_string_value(json_object_get(message, "audio")),
                  json_string_value(json_object_get(message, "fap")), &e))
        socket_complain(s, &e);
}

static void authorise(struct socket *s, const json_t *message) {
    const char *token = json_string_value(json_object_get(message, "token"));
    struct error e;
    if (token ? guest_show(s->net, &s->guest, token, &e)
              : error_in_field(&e, "missing-field", "token", "is missing"))
        socket_complain(s, &e);
    else
        socket_say(s, json_pack("{ss ss}", "type", "authorized", "subject", s->guest.token.subject));
}

void socket_act(struct socket *s, const json_t *message) {
    static const struct {
        const char *type;
        void (*act)(struct socket *s, const json_t *message);
    } types[] = {{"speak", speak_json},      {"stop", control_stop},   {"pause", control_pause},
                 {"resume", control_resume}, {"rate", control_rate},   {"jump", control_jump},
                 {"play", control_play},     {"idle", control_idle},   {"express", control_express},
                 {"model", send_model},      {"media", choose_media},  {"join", join_room},
                 {"leave", leave_room},      {"authorize", authorise}, {"ping", pong}};
    const char *type = json_string_value(json_object_get(message, "type"));
    struct error e;
    if (!json_is_object(message) || !type) {
        error_in_field(&e, "bad-message", "type", "a message is an object with a string 'type'");
        socket_complain(s, &e);
        return;
    }
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcmp(types[i].type, type)) {
            types[i].act(s, message);
            return;
        }
    error_in_field(&e, "unknown-type", "type", "no message type '%s'", type);
    socket_complain(s, &e);
}

/* A whole text message. */
static void hear(struct socket *s, const char *data, size_t size) {
    size_t blank = 0;
    if (s->plain) {
        text_hear(s, data, size);
        return;
    }
    while (blank < size && strchr(" \t\r\n", data[blank]))
        blank++;
    if (blank == size || data[blank] != '{') {
        socket_speak(s, data, size);
        return;
    }
    json_error_t why;
    struct error e;
    json_t *message = json_loadb(data, size, JSON_ALLOW_NUL, &why);
    if (message) {
        socket_act(s, message);
        json_decref(message);
        return;
    }
    /* jansson counts the character that it stumbled over, unless it was the end */
    size_t at = (size_t)why.position;
    if (at && json_error_code(&why) != json_error_premature_end_of_input)
        at--;
    error_at_byte(&e, "bad-json", at, "%s", why.text);
    socket_complain(s, &e);
}

int socket_receive(struct socket *s, const char *data, size_t size) {
    bool whole = lws_is_final_fragment(s->wsi) && !lws_remaining_packet_payload(s->wsi);
    bool binary = lws_frame_is_binary(s->wsi);
    if (s->message.size + size > s->net->options.message_bytes)
        s->too_long = true;
    if (!binary && !s->too_long)
        buf_add(&s->message, data, size);
    if (!whole)
        return 0;
    struct error e;
    if (s->too_long) {
        error_set(&e, "message-too-long", "a message may have %u bytes", s->net->options.message_bytes);
        socket_complain(s, &e);
    } else if (binary) {
        error_set(&e, "binary-message", "a client sends no binary messages");
        socket_complain(s, &e);
    } else {
        hear(s, s->message.size ? (const char *)s->message.data : "", s->message.size);
    }
    buf_free(&s->message);
    s->too_long = false;
    return 0;
}

/* What lws_close_reason does, had it a chance: with libuv, libwebsockets 4.1 closes a connection whose
 * callback returned -1 twice, the second time without waiting for its close frame. So that frame (RFC
 * 6455, 5.5.1) is written here, by the number that the library has for it, and the client's answer ends the
 * connection. */
static int say_goodbye(struct socket *s) {
    enum { WRITE_CLOSE = 4, STATUS_BYTES = 2, REASON_BYTES = 64 };
    uint8_t frame[LWS_PRE + STATUS_BYTES + REASON_BYTES], *payload = frame + LWS_PRE;
    size_t size = strlen(s->doomed) < REASON_BYTES ? strlen(s->doomed) : REASON_BYTES;
    payload[0] = (uint8_t)(s->doom >> 8);
    payload[1] = (uint8_t)s->doom;
    memcpy(payload + STATUS_BYTES, s->doomed, size);
    lws_set_timeout(s->wsi, PENDING_TIMEOUT_CLOSE_ACK, GOODBYE_SECONDS);
    return lws_write(s->wsi, payload, STATUS_BYTES + size, (enum lws_write_protocol)WRITE_CLOSE) < 0 ? -1 : 0;
}

int socket_writeable(struct socket *s) {
    if (s->closing)
        return 0;
    /* he who is too slow gets nothing more; others get what is on its way */
    if (s->doomed && (outbox_empty(&s->outbox) || s->outbox.unsent > s->net->options.send_bytes_max)) {
        s->closing = true;
        return say_goodbye(s);
    }
    struct parcel *parcel = outbox_pop(&s->outbox);
    if (!parcel)
        return 0;
    int sent = lws_write(s->wsi, parcel_body(parcel), parcel->size, parcel->type);
    metrics_add(s->net->studio->metrics, METRIC_SENT_BYTES, (double)parcel->size);
    parcel_release(parcel);
    if (sent < 0)
        return -1;
    if (s->deaf && s->outbox.unsent <= s->net->options.send_bytes) {
        s->deaf = false;
        lws_rx_flow_control(s->wsi, 1);
    }
    if (s->follower.lagging && outbox_empty(&s->outbox)) {
        s->follower.lagging = false;
        channel_resume(&s->follower);
    }
    s->progress = uv_now(s->net->studio->loop);
    if (outbox_empty(&s->outbox) && s->model)
        push_model_part(s);
    if (!outbox_empty(&s->outbox) || s->doomed)
        lws_callback_on_writable(s->wsi);
    return 0;
}

bool sockets_busy(const struct net *net) {
    for (const struct socket *s = net->sockets; s; s = s->next)
        if (!outbox_empty(&s->outbox) || stream_busy(socket_stream(s)))
            return true;
    return false;
}

void sockets_dismiss(struct net *net, const char *reason) {
    for (struct socket *s = net->sockets; s; s = s->next)
        dismiss(s, LWS_CLOSE_STATUS_GOINGAWAY, reason);
}
