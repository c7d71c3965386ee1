/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Room commands over HTTP: as the JSON of a message, by the short routes, and as a text to be spoken,
 * which may still be written meanwhile. */
#include "server/access/token.h"
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/base/json/surrogates.h"
#include "server/base/mem.h"
#include "server/rooms/question.h"
#include "server/rooms/repeat.h"
#include "server/rooms/shared/forward.h"
#include <stdlib.h>
#include <string.h>

struct channel *room_asked(struct exchange *x, int *result) {
    char value[TOKEN_ROOM + 2];
    struct error e;
    const char *name = exchange_query(x, "room", value, sizeof value);
    struct channel *channel = name ? channel_find(exchange_api(x)->rooms, name) : NULL;
    if (!name)
        error_plain_in_field(&e, ERROR_MISSING_FIELD, "room");
    else if (!channel)
        error_in_field(&e, ERROR_UNKNOWN_ROOM, "room", "there is nobody in the room '%s'", name);
    else
        return channel;
    *result = exchange_error(x, &e);
    return NULL;
}

/* A request that is answered once its command has run, here or on the daemon that leads the room. */
struct command_post {
    struct post_text text;         /* of a text to be spoken; its x is always set */
    const struct command *command; /* NULL: named by the message */
    char room[TOKEN_ROOM + 1];
    struct forward *forward; /* pending on another daemon; or NULL */
    struct question_watch watch;
};

static void on_forwarded(void *ctx, unsigned status, const json_t *answer) {
    struct command_post *p = ctx;
    p->forward = NULL;
    exchange_json(p->text.x, status, json_copy((json_t *)answer));
}

static int forward(struct command_post *p, json_t *packed) {
    struct forward *forward =
        forward_command(exchange_api(p->text.x)->rooms, p->room, packed, on_forwarded, p);
    if (forward)
        p->forward = forward;
    return 0;
}

static void on_answered(void *ctx, const json_t *answered) {
    struct command_post *p = ctx;
    exchange_json(p->text.x, 200, json_copy((json_t *)answered));
}

/* Answers when the question has its answer. False: it has none any more. */
static bool awaits(struct command_post *p, const struct command_call *call) {
    p->watch = (struct question_watch){.answered = on_answered, .ctx = p};
    if (!call->asks || !question_watch_begin(&p->watch, call->channel))
        return false;
    json_decref(call->answer);
    return true;
}

static bool is_forwarded(const struct api *api, const char *room) {
    struct error ignored;
    return !channel_check_name(room, &ignored) && forward_needed(api->rooms, room);
}

bool room_is_remote(const struct exchange *x) {
    const char *room = http_query(exchange_request(x), "room");
    return room && is_forwarded(exchange_api(x), room);
}

/* Runs the command, or forwards it. */
static int give(struct command_post *p, const struct command *command, struct command_call *call) {
    struct exchange *x = p->text.x;
    struct error e;
    if (command_permit(command, call, exchange_principal(x), &e) ||
        (call->request && command_admit(call, exchange_principal(x), &e)))
        return exchange_error(x, &e);
    if (is_forwarded(call->api, p->room)) {
        json_t *packed = command_pack(command, call, &e);
        return packed ? forward(p, packed) : exchange_error(x, &e);
    }
    if (command_run(command, call, &e))
        return exchange_error(x, &e);
    return awaits(p, call) ? 0 : exchange_json(x, call->status, call->answer);
}

static struct command_call call_of(const struct command_post *p, const json_t *message,
                                   struct speech_request *request) {
    struct api *api = exchange_api(p->text.x);
    return (struct command_call){.api = api,
                                 .room = p->room,
                                 .channel = channel_occupied(api->rooms, p->room),
                                 .message = message,
                                 .request = request,
                                 .by = exchange_principal(p->text.x)->token.subject};
}

/* Handles a message that speaks: its members are those of a request. */
static int give_speech(struct command_post *p, const struct command *command, const json_t *message) {
    static const char *const more[] = {"type", "name", "choices", "seconds", "wait", NULL};
    static const struct members known = {.speech = true, .more = more};
    struct exchange *x = p->text.x;
    bool speak = !strcmp(command->name, "speak");
    struct speech_request request;
    struct error e;
    int result;
    request_init(&request);
    json_t *members = json_copy((json_t *)message);
    json_object_del(members, "text");
    members_check(members, &known, exchange_warn, x);
    json_decref(members);
    struct command_call call = call_of(p, message, &request);
    call.keeps = speak;
    int failed = command_request(command, message, &request, &e);
    if (!failed && request.open)
        failed = error_in_field(&e, ERROR_BAD_FIELD, "open",
                                "send a text piece by piece over a WebSocket, or to /v1/say");
    if (!failed && speak && !request.text && !request.passage)
        failed = error_plain_in_field(&e, ERROR_MISSING_FIELD, "text");
    result = failed ? exchange_error(x, &e) : give(p, command, &call);
    request_free(&request);
    return result;
}

static int give_message(struct command_post *p, const json_t *message) {
    struct exchange *x = p->text.x;
    struct error e;
    const struct command *command = p->command ? p->command : command_of(message, &e);
    if (command && command->act)
        error_in_field(&e, ERROR_UNKNOWN_TYPE, "type", "'%s' is only for WebSocket clients", command->name);
    if (!command || command->act)
        return exchange_error(x, &e);
    if (command->speaks)
        return give_speech(p, command, message);
    struct command_call call = call_of(p, message, NULL);
    return give(p, command, &call);
}

static int on_message_end(void *self) {
    struct command_post *p = self;
    const struct buf *body = exchange_body(p->text.x);
    struct error e;
    json_error_t why;
    json_t *message = surrogates_load(body->size ? (const char *)body->data : "", body->size, &why);
    int result =
        message ? give_message(p, message) : (error_bad_json(&why, &e), exchange_error(p->text.x, &e));
    json_decref(message);
    return result;
}

static void on_free(void *self) {
    struct command_post *p = self;
    forward_forget(p->forward);
    question_watch_end(&p->watch);
    post_text_free(&p->text);
    free(p);
}

static struct command_post *post_open(struct exchange *x, const char *room, int (*body_end)(void *self)) {
    struct command_post *p = mem_alloc(sizeof *p);
    p->text.x = x;
    snprintf(p->room, sizeof p->room, "%s", room);
    exchange_set_work(x, (struct exchange_work){.body_end = body_end, .free = on_free, .self = p});
    return p;
}

/* An unknown name is just an empty room. A name that is too long must be rejected: truncated, it could
 * match another room. */
static int check_room(const char *room, struct error *e) {
    if (!room)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "room");
    return strlen(room) > TOKEN_ROOM ? channel_check_name(room, e) : 0;
}

static int post_message(struct exchange *x, const char *room, const struct command *command) {
    struct error e;
    if (check_room(room, &e))
        return exchange_error(x, &e);
    struct command_post *p = post_open(x, room, on_message_end);
    p->command = command;
    exchange_expect_body(x, exchange_api(x)->options.http.message_bytes, ERROR_MESSAGE_TOO_LONG);
    return 0;
}

int room_commands(struct exchange *x, const char *room) {
    return post_message(x, room, NULL);
}

int room_command(struct exchange *x, const char *type) {
    const struct command *command = command_find(type);
    const char *room = http_query(exchange_request(x), "room");
    struct error e;
    if (!command->bare)
        return post_message(x, room, command);
    if (check_room(room, &e))
        return exchange_error(x, &e);
    struct command_post *p = post_open(x, room, NULL);
    struct command_call call = call_of(p, NULL, NULL);
    return give(p, command, &call);
}

int room_forward(struct exchange *x, json_t *packed) {
    return forward(post_open(x, http_query(exchange_request(x), "room"), NULL), packed);
}

/* Speaking a text */

static const struct members say_members = {.speech = true};

static int on_text_end(void *self) {
    struct command_post *p = self;
    struct speech_request request;
    struct error e;
    request_init(&request);
    struct command_call call = call_of(p, NULL, &request);
    call.keeps = true;
    int result = post_text_request(&p->text, &request, &e) ? exchange_error(p->text.x, &e)
                                                           : give(p, command_find("speak"), &call);
    request_free(&request);
    return result;
}

/* A text written to a room: the part received is spoken while the rest is written. */
struct text_post {
    struct post_text text;
    uint64_t channel; /* its number, since another room of that name may replace it */
    uint32_t utterance;
    int listeners;
};

/* Returns the stream of the room, or NULL if the room is gone. */
static struct stream *stream_of(const struct text_post *p) {
    const char *room = http_query(exchange_request(p->text.x), "room");
    struct channel *channel = channel_find(exchange_api(p->text.x)->rooms, room);
    return channel && channel_number(channel) == p->channel ? channel_stream(channel) : NULL;
}

static void on_written(void *self, const void *data, size_t size) {
    struct text_post *p = self;
    struct stream *stream = stream_of(p);
    struct error e;
    if (stream &&
        stream_write(stream, p->utterance, data, size, exchange_api(p->text.x)->options.text_bytes, &e)) {
        stream_close(stream, p->utterance, &e);
        p->utterance = 0;
        exchange_error(p->text.x, &e);
    }
}

static int on_written_end(void *self) {
    struct text_post *p = self;
    struct stream *stream = stream_of(p);
    if (stream)
        stream_close(stream, p->utterance, NULL);
    p->utterance = 0;
    return exchange_json(p->text.x, 202,
                         json_pack("{ss ss si}", "type", "accepted", "room",
                                   http_query(exchange_request(p->text.x), "room"), "listeners",
                                   p->listeners));
}

static void free_written(void *self) {
    struct text_post *p = self;
    struct stream *stream = p->utterance ? stream_of(p) : NULL;
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "its writer disconnected: the text is spoken as far as it was written");
    if (stream)
        stream_close(stream, p->utterance, &e);
    post_text_free(&p->text);
    free(p);
}

static int speak_written(struct text_post *p, struct speech_request *request, struct error *e) {
    struct exchange *x = p->text.x;
    const char *room = http_query(exchange_request(x), "room");
    if (p->text.json)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "a text sent piece by piece is plain, not JSON");
    struct channel *channel = channel_find(exchange_api(x)->rooms, room);
    if (channel && channel_is_remote(channel))
        return error_set(e, ERROR_ROOM_AWAY,
                         "another daemon leads this room: send a text piece by piece to that daemon");
    if (!channel)
        return error_in_field(e, ERROR_UNKNOWN_ROOM, "room", "there is nobody in the room '%s'", room);
    struct command_call call = {.api = exchange_api(x), .request = request};
    if (post_text_request(&p->text, request, e) || command_admit(&call, exchange_principal(x), e))
        return -1;
    if (!request->open)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "must be true if it is given");
    p->channel = channel_number(channel);
    p->listeners = (int)channel_listeners(channel);
    p->utterance = channel_speak(channel, request, NULL);
    return 0;
}

static int write_text(struct exchange *x) {
    int result = 0;
    struct speech_request request;
    struct error e = {0};
    struct text_post *p = mem_alloc(sizeof *p);
    exchange_set_work(x,
                      (struct exchange_work){
                          .body = on_written, .body_end = on_written_end, .free = free_written, .self = p});
    if (post_text_begin(&p->text, x, &say_members, &result))
        return result;
    request_init(&request);
    if (speak_written(p, &request, &e))
        result = exchange_error(x, &e);
    request_free(&request);
    return result;
}

int room_say(struct exchange *x) {
    const char *room = http_query(exchange_request(x), "room");
    struct error e;
    int result = 0;
    if (check_room(room, &e) || channel_check_name(room, &e))
        return exchange_error(x, &e);
    if (http_query(exchange_request(x), "open"))
        return write_text(x);
    post_text_begin(&post_open(x, room, on_text_end)->text, x, &say_members, &result);
    return result;
}
