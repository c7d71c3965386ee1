/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a WebSocket client sends: messages, taken in pieces and acted on. */
#include "server/base/near.h"
#include "server/base/utf8.h"
#include "server/net/socket_internal.h"
#include "server/net/surrogates.h"
#include <stdio.h>
#include <string.h>

/* The longest id, in bytes. */
enum { ID_BYTES = 64 };

static void speak_json(struct socket *s, const json_t *message) {
    struct speech_request request;
    struct error e = {0};
    request_copy(&request, &s->defaults);
    if (request_from_json(&request, message, &e))
        socket_refuse(s, request.id, &e);
    else
        socket_speak_request(s, &request);
    request_free(&request);
}

static void pong(struct socket *s, const json_t *message) {
    json_t *answer = json_pack("{ss}", "type", "pong");
    json_object_set(answer, "id", json_object_get(message, "id"));
    socket_say(s, answer);
}

static void join_room(struct socket *s, const json_t *message) {
    const char *room = json_string_value(json_object_get(message, "room"));
    const json_t *watch = json_object_get(message, "watch"), *as = json_object_get(message, "as");
    const char *called = json_string_value(as);
    struct error e;
    if (watch && !json_is_boolean(watch)) {
        error_in_field(&e, ERROR_BAD_FIELD, "watch", "must be true or false");
        socket_complain(s, &e);
        return;
    }
    if (as && (!called || strlen(called) != json_string_length(as) || strlen(called) > DESK_NAME_BYTES)) {
        error_in_field(&e, ERROR_BAD_FIELD, "as", "must be a string of at most %d bytes", DESK_NAME_BYTES);
        socket_complain(s, &e);
        return;
    }
    if (room ? socket_join(s, room, json_is_true(watch), called, &e)
             : error_plain_in_field(&e, ERROR_MISSING_FIELD, "room"))
        socket_complain(s, &e);
}

static void leave_room(struct socket *s, const json_t *message) {
    (void)message;
    if (socket_room(s))
        socket_leave(s);
}

static void choose_media(struct socket *s, const json_t *message) {
    const json_t *kilobits = json_object_get(message, "kilobits"),
                 *blocked = json_object_get(message, "blocked");
    char number[32];
    struct media_wish wish = {json_string_value(json_object_get(message, "audio")),
                              json_string_value(json_object_get(message, "fap")),
                              json_string_value(json_object_get(message, "events")), NULL};
    static const char *const texts[] = {"audio", "fap", "events"};
    struct error e;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        const json_t *value = json_object_get(message, texts[i]);
        if (value && !json_is_string(value)) {
            error_in_field(&e, ERROR_BAD_FIELD, texts[i], "must be a string");
            socket_complain(s, &e);
            return;
        }
    }
    if (blocked && !json_is_boolean(blocked)) {
        error_in_field(&e, ERROR_BAD_FIELD, "blocked", "must be true or false");
        socket_complain(s, &e);
        return;
    }
    if (blocked)
        s->follower.blocked = json_is_true(blocked);
    if (kilobits) {
        snprintf(number, sizeof number, "%.12g", json_number_value(kilobits));
        wish.kilobits = number;
    }
    if (socket_set_media(s, &wish, &e))
        socket_complain(s, &e);
}

static void authorise(struct socket *s, const json_t *message) {
    const char *token = json_string_value(json_object_get(message, "token"));
    struct error e;
    if (token ? principal_show(s->net, &s->principal, token, &e)
              : error_plain_in_field(&e, ERROR_MISSING_FIELD, "token"))
        socket_complain(s, &e);
    else {
        socket_say(s, json_pack("{ss ss}", "type", "authorized", "subject", s->principal.token.subject));
        socket_authorized(s);
    }
}

static void act(struct socket *s, const json_t *message) {
    static const struct {
        const char *type;
        void (*act)(struct socket *s, const json_t *message);
    } types[] = {{"speak", speak_json},        {"stop", control_stop},    {"pause", control_pause},
                 {"resume", control_resume},   {"rate", control_rate},    {"jump", control_jump},
                 {"play", control_play},       {"idle", control_idle},    {"express", control_express},
                 {"model", socket_send_model}, {"media", choose_media},   {"join", join_room},
                 {"leave", leave_room},        {"authorize", authorise},  {"ping", pong},
                 {"choices", notice_offer},    {"choose", notice_answer}, {"state", notice_show},
                 {"text", write_text},         {"flush", write_flush},    {"close", write_close},
                 {"cancel", write_cancel},     {"calibrate", notice_fit}, {"consent", notice_consent},
                 {"voice", voice_begin}};
    const char *type = json_string_value(json_object_get(message, "type"));
    struct error e;
    if (!json_is_object(message) || !type) {
        error_in_field(&e, ERROR_BAD_MESSAGE, "type", "a message is an object with a string 'type'");
        socket_complain(s, &e);
        return;
    }
    if (socket_order(s, type, message))
        return;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcmp(types[i].type, type)) {
            types[i].act(s, message);
            return;
        }
    struct near near = near_to(type);
    char text[NEAR_TEXT];
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        near_try(&near, types[i].type, types[i].type);
    error_in_field(&e, ERROR_UNKNOWN_TYPE, "type", "no message type '%.80s'%s", type, near_text(&near, text));
    socket_complain(s, &e);
}

/* What is refused is answered with the id of the message, if it has one that can be read. */
void socket_act(struct socket *s, const json_t *message) {
    const json_t *id = json_object_get(message, "id");
    const char *value = json_string_value(id);
    s->asked =
        value && json_string_length(id) <= ID_BYTES && strlen(value) == json_string_length(id) ? value : NULL;
    act(s, message);
    s->asked = NULL;
}

/* The string of that member in what may be no JSON, without escapes and at most ID_BYTES long. */
static bool find_member(const char *data, size_t size, const char *name, char out[ID_BYTES + 1]) {
    char quoted[16];
    size_t bytes = (size_t)snprintf(quoted, sizeof quoted, "\"%s\"", name), n = 0;
    const char *end = data + size, *at = size ? memmem(data, size, quoted, bytes) : NULL;
    if (!at)
        return false;
    for (at += bytes; at < end && strchr(" \t\r\n:", *at) && *at; at++)
        ;
    if (at == end || *at++ != '"')
        return false;
    for (; at < end && *at != '"' && *at != '\\' && (unsigned char)*at >= ' ' && n < ID_BYTES; at++)
        out[n++] = *at;
    out[n] = '\0';
    return at < end && *at == '"' && utf8_check(out, n) == n;
}

/* A message that is no JSON, or is too long to be kept: what would have begun to speak ends, so that whoever
 * waits for it is told. */
static void refuse_unread(struct socket *s, const char *data, size_t size, const struct error *e) {
    char id[ID_BYTES + 1], type[ID_BYTES + 1];
    bool known = find_member(data, size, "id", id);
    s->asked = known ? id : NULL;
    if (known && find_member(data, size, "type", type) &&
        (!strcmp(type, "speak") || !strcmp(type, "voice") || !strcmp(type, "play")))
        socket_refuse(s, id, e);
    else
        socket_complain(s, e);
    s->asked = NULL;
}

static void take(struct socket *s, const json_t *message, const json_error_t *why, const char *data,
                 size_t size) {
    struct error e;
    if (message) {
        socket_act(s, message);
        return;
    }
    message_bad_json(why, &e);
    refuse_unread(s, data, size, &e);
}

void socket_hear_json(struct socket *s, const char *data, size_t size) {
    size_t blank = 0;
    while (blank < size && strchr(" \t\r\n", data[blank]))
        blank++;
    if (blank == size || data[blank] != '{') {
        socket_speak(s, data, size);
        return;
    }
    size_t is_long = s->net->pipeline->long_text;
    if (is_long && size >= is_long) {
        socket_read_long(s, &s->message, take);
        return;
    }
    json_error_t why;
    json_t *message = surrogates_load(data, size, &why);
    take(s, message, &why, data, size);
    json_decref(message);
}

void socket_hear(struct socket *s, bool binary) {
    struct error e;
    if (s->too_long) {
        error_set(&e, ERROR_MESSAGE_TOO_LONG, "a message may have at most %u bytes",
                  s->net->options.message_bytes);
        refuse_unread(s, s->message.size ? (const char *)s->message.data : "", s->message.size, &e);
    } else if (binary) {
        voice_sound(s, s->message.data, s->message.size);
    } else {
        s->hear(s, s->message.size ? (const char *)s->message.data : "", s->message.size);
    }
    buf_free(&s->message);
    s->too_long = false;
}
