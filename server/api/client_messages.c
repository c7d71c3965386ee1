/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages from a WebSocket client, handled in order. Long ones are parsed and freed in another thread. */
#include "server/api/client_internal.h"
#include "server/api/commands.h"
#include "server/base/json/surrogates.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/base/work/work_limit.h"
#include "server/rooms/shared/forward.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A command that is sent to everyone in a room costs as much as the room has members. A hand on the mood disc
 * sends at most 120 per second. */
enum {
    COMMANDS_A_SECOND = 120, /* average of one client */
    COMMANDS_BURST = 400,    /* most at once */
};

/* The longest id, in bytes. */
enum { ID_BYTES = 64 };

/* A forwarded command. Keeps the client's number to report a failure, since the client may be gone by
 * then. */
struct forwarded {
    struct api *api;
    uint64_t number; /* of the client */
    bool speech;     /* report its end, too */
    char *id;        /* or NULL */
};

static json_t *marked(const struct forwarded *f, json_t *message) {
    if (f->id)
        json_object_set_new(message, "id", json_string(f->id));
    return message;
}

static void on_forwarded(void *ctx, unsigned status, const json_t *answer) {
    struct forwarded *f = ctx;
    struct client *c = f->api->clients;
    while (c && c->number != f->number)
        c = c->next;
    if (c && status >= 400) {
        client_say(c, marked(f, json_copy((json_t *)answer)));
        if (f->speech)
            client_say(c, marked(f, json_pack("{ss ss}", "type", "end", "reason", "failed")));
    }
    free(f->id);
    free(f);
}

static int forward(struct client *c, const struct command *command, const struct command_call *call,
                   struct error *e) {
    json_t *packed = command_pack(command, call, e);
    if (!packed)
        return -1;
    const char *id = call->request ? call->request->id : NULL;
    struct forwarded *f = mem_alloc(sizeof *f);
    *f = (struct forwarded){c->api, c->number, call->request != NULL, id ? mem_strdup(id) : NULL};
    forward_command(c->api->rooms, call->room, packed, on_forwarded, f);
    return 0;
}

/* Unfinished texts are accepted only by the daemon that leads the room. */
static int check_open(struct client *c, const struct speech_request *request, struct error *e) {
    if (channel_is_remote(c->follower.channel))
        return error_set(e, ERROR_ROOM_AWAY,
                         "another daemon leads this room: send a text piece by piece to that daemon");
    return open_text_check(c, request, e);
}

/* Charges a command that is sent to others. Returns -1 with *e when the limit is exceeded. */
static int count_command(struct client *c, struct error *e) {
    const uint64_t now = uv_hrtime(), each = 1000000000 / COMMANDS_A_SECOND;
    uint64_t from = c->commanded > now ? c->commanded : now;
    if (from + each - now > each * COMMANDS_BURST)
        return error_set(e, ERROR_TOO_MANY_REQUESTS,
                         "a client may send a room %d commands per second, and %d at once", COMMANDS_A_SECOND,
                         COMMANDS_BURST);
    c->commanded = from + each;
    return 0;
}

static int do_command(struct client *c, const struct command *command, struct command_call *call,
                      struct error *e) {
    struct speech_request *request = call->request;
    bool open = request && request->open;
    if (command_permit(command, call, &c->principal, e) ||
        (request ? principal_ask(c->api, &c->principal, e) : call->room && count_command(c, e)) ||
        (request && command_admit(call, &c->principal, e)) || (open && check_open(c, request, e)))
        return -1;
    if (call->room && !open && forward_needed(c->api->rooms, call->room))
        return forward(c, command, call, e);
    if (command_run(command, call, e))
        return -1;
    json_decref(call->answer);
    if (open && call->utterance)
        open_text_begin(c, request->id, call->utterance, request->half);
    return 0;
}

static void give(struct client *c, const struct command *command, const json_t *message,
                 struct speech_request *request) {
    struct command_call call = {.api = c->api,
                                .room = client_room(c),
                                .channel = c->follower.channel,
                                .message = message,
                                .request = request,
                                .by = client_called(c),
                                .observes = c->follower.watches};
    struct error e = {0};
    if (!do_command(c, command, &call, &e))
        return;
    if (request)
        client_refuse(c, request->id, &e);
    else
        client_complain(c, &e);
}

/* Handles speak, ask and play. Speech uses the client's defaults. */
static void give_speech(struct client *c, const struct command *command, const json_t *message) {
    struct speech_request request;
    struct error e = {0};
    if (strcmp(command->name, "play") != 0)
        request_copy(&request, &c->defaults);
    else
        request_init(&request);
    if (command_request(command, message, &request, &e))
        client_refuse(c, request.id, &e);
    else
        give(c, command, message, &request);
    request_free(&request);
}

static void act_on_client(struct client *c, const struct command *command, const json_t *message) {
    struct error e;
    bool tells = command->act == client_join ||
                 ((command->act == client_authorize || command->act == client_drive) && client_room(c));
    if (!client_message_check(command->name, message, &e) && !(tells && count_command(c, &e)))
        command->act(c, message);
    else if (command->act == client_voice_begin)
        client_refuse(c, c->asked, &e);
    else
        client_complain(c, &e);
}

static void act(struct client *c, const json_t *message) {
    struct error e;
    const struct command *command = command_of(message, &e);
    if (!command)
        client_complain(c, &e);
    else if (command->act)
        act_on_client(c, command, message);
    else if (command->speaks)
        give_speech(c, command, message);
    else
        give(c, command, message, NULL);
}

/* Errors carry the id of the message, if it has a valid one. */
void client_act(struct client *c, const json_t *message) {
    const json_t *id = json_object_get(message, "id");
    const char *value = json_string_value(id);
    c->asked =
        value && json_string_length(id) <= ID_BYTES && strlen(value) == json_string_length(id) ? value : NULL;
    act(c, message);
    c->asked = NULL;
}

void client_speak(struct client *c, const char *text, size_t size) {
    struct speech_request request;
    struct error e;
    request_copy(&request, &c->defaults);
    request_set(&request, "text", (struct request_value){REQUEST_STRING, text, size, 0}, &e);
    give(c, command_find("speak"), NULL, &request);
    request_free(&request);
}

/* Finds a string member in possibly invalid JSON. Accepts only strings without escapes of at most
 * ID_BYTES. */
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

/* Refuses a message that is not JSON or is too long. An utterance it would have begun also gets its end,
 * for clients that wait for it. */
static void refuse_unread(struct client *c, const char *data, size_t size, const struct error *e) {
    char id[ID_BYTES + 1], type[ID_BYTES + 1];
    bool known = find_member(data, size, "id", id);
    c->asked = known ? id : NULL;
    if (known && find_member(data, size, "type", type) &&
        (!strcmp(type, "speak") || !strcmp(type, "voice") || !strcmp(type, "play") || !strcmp(type, "ask")))
        client_refuse(c, id, e);
    else
        client_complain(c, e);
    c->asked = NULL;
}

static void take(struct client *c, const json_t *message, const json_error_t *why, const char *data,
                 size_t size) {
    struct error e;
    if (message) {
        client_act(c, message);
        return;
    }
    error_bad_json(why, &e);
    refuse_unread(c, data, size, &e);
}

/* Parsing in another thread */

struct long_message {
    uv_work_t work;
    struct client *client; /* NULL: it is gone */
    struct buf text;
    json_t *message;
    json_error_t why;
    atomic_bool given_up; /* tells the thread that the client is gone */
};

static void parse(uv_work_t *work) {
    struct long_message *m = work->data;
    struct work_limit limit = work_limit_begin(&m->given_up, 0); /* the message's size bounds the work */
    m->message = surrogates_load_until((const char *)m->text.data, m->text.size, &limit, &m->why);
}

static void drop(uv_work_t *work) {
    struct long_message *m = work->data;
    json_decref(m->message);
    buf_free(&m->text);
}

static void after_drop(uv_work_t *work, int status) {
    if (status) /* cancelled before it ran in the other thread */
        drop(work);
    free(work->data);
}

static void after_parse(uv_work_t *work, int status) {
    struct long_message *m = work->data;
    struct client *c = m->client;
    uv_loop_t *loop = work->loop;
    if (c) {
        c->reading = NULL;
        if (!status && !websocket_closing(c->ws))
            take(c, m->message, &m->why, (const char *)m->text.data, m->text.size);
        websocket_hold(c->ws, c->reading != NULL);
    }
    if (uv_queue_work(loop, &m->work, drop, after_drop))
        after_drop(&m->work, UV_ECANCELED);
}

/* Later messages of the client wait. */
static void read_long(struct client *c, struct buf *message) {
    struct long_message *m = mem_alloc(sizeof *m);
    m->client = c;
    m->text = *message;
    m->work.data = m;
    *message = (struct buf){0};
    c->reading = m;
    websocket_hold(c->ws, true);
    uv_queue_work(c->api->pipeline->loop, &m->work, parse, after_parse);
}

void client_forget_reading(struct client *c) {
    if (!c->reading)
        return;
    c->reading->client = NULL;
    atomic_store(&c->reading->given_up, true);
    uv_cancel((uv_req_t *)&c->reading->work); /* if it is running already, given_up ends it soon */
}

/* Acts on JSON and speaks any other text. */
static void hear_text(struct client *c, struct buf *message) {
    const char *data = message->size ? (const char *)message->data : "";
    size_t size = message->size, blank = 0, is_long = c->api->pipeline->long_text;
    while (blank < size && strchr(" \t\r\n", data[blank]))
        blank++;
    if (blank == size || data[blank] != '{') {
        client_speak(c, data, size);
    } else if (is_long && size >= is_long) {
        read_long(c, message);
    } else {
        json_error_t why;
        json_t *read = surrogates_load(data, size, &why);
        take(c, read, &why, data, size);
        json_decref(read);
    }
}

void client_hear(struct client *c, struct buf *message, bool binary, bool too_long) {
    const char *data = message->size ? (const char *)message->data : "";
    struct error e;
    if (too_long) {
        error_set(&e, ERROR_MESSAGE_TOO_LONG, "a message may have at most %u bytes",
                  c->api->options.http.message_bytes);
        refuse_unread(c, data, message->size, &e);
    } else if (binary) {
        client_voice_sound(c, message->data, message->size);
    } else if (c->plain) {
        text_hear(c, data, message->size);
    } else {
        hear_text(c, message);
    }
}
