/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a WebSocket client asks of a room in which another daemon speaks. */
#include "server/base/mem.h"
#include "server/net/client_message.h"
#include "server/net/consent.h"
#include "server/net/orders.h"
#include "server/net/socket_internal.h"
#include <stdlib.h>
#include <string.h>

/* Who is told when it fails: the client may have gone meanwhile. */
struct asking {
    struct net *net;
    uint64_t number; /* of the socket */
    bool speech;     /* its end is told, too */
    char *id;        /* or NULL */
};

static json_t *marked(const struct asking *a, json_t *message) {
    if (a->id)
        json_object_set_new(message, "id", json_string(a->id));
    return message;
}

static void on_done(void *ctx, unsigned status, const json_t *answer) {
    struct asking *a = ctx;
    struct socket *s = a->net->sockets;
    while (s && s->number != a->number)
        s = s->next;
    if (s && status >= 400) {
        socket_say(s, marked(a, json_copy((json_t *)answer)));
        if (a->speech)
            socket_say(s, marked(a, json_pack("{ss ss}", "type", "end", "reason", "failed")));
    }
    free(a->id);
    free(a);
}

static void give(struct socket *s, json_t *order, bool speech, const char *id) {
    struct asking *a = mem_alloc(sizeof *a);
    *a = (struct asking){s->net, s->number, speech, id ? mem_strdup(id) : NULL};
    json_object_set_new(order, "by", json_string(socket_called(s)));
    order_give(s->net, socket_room(s), order, on_done, a);
}

static bool is_needed(const struct socket *s) {
    const char *room = socket_room(s);
    return room && order_needed(s->net, room);
}

bool socket_order_speech(struct socket *s, const struct speech_request *request) {
    struct error e;
    if (!is_needed(s) || (request->open && !channel_elsewhere(s->follower.channel)))
        return false;
    json_t *wanted = request_to_json(request);
    if (!wanted)
        error_plain(&e, ERROR_BAD_UTF8);
    else if (request->open)
        error_set(&e, ERROR_ROOM_AWAY,
                  "another daemon speaks in this room: a text that is being written goes to that one");
    else
        give(s,
             json_pack("{ss sO sI sI}", "type", "speak", "request", wanted, "payer",
                       (json_int_t)request->payer, "asker", (json_int_t)request->asker),
             true, request->id);
    if (!wanted || request->open)
        socket_refuse(s, request->id, &e);
    json_decref(wanted);
    return true;
}

/* A recording of the folder that the room's home has. */
static void play(struct socket *s, const json_t *message) {
    struct speech_request request;
    struct error e;
    request_init(&request);
    if (client_message_request("play", message, &request, &e) || socket_may_speak(s, &e))
        socket_refuse(s, request.id, &e);
    else
        give(s,
             json_pack("{ss sO so}", "type", "play", "message", (json_t *)message, "request",
                       request_to_json(&request)),
             true, request.id);
    request_free(&request);
}

static int may(struct socket *s, const char *type, const json_t *message, struct error *e) {
    bool answer = false;
    if (!strcmp(type, "choose"))
        return 0;
    if (!strcmp(type, "consent") && consent_is_answer(message, &answer, e))
        return -1;
    if (answer)
        return s->follower.watches ? error_set(e, ERROR_FORBIDDEN, "only who listens can consent") : 0;
    return socket_may_direct(s, e);
}

bool socket_order(struct socket *s, const char *type, const json_t *message) {
    static const char *const types[] = {"stop",    "pause",   "resume", "rate",  "jump",      "cancel",
                                        "express", "choices", "choose", "state", "calibrate", "consent"};
    struct error e;
    size_t i = 0;
    if (!is_needed(s))
        return false;
    if (!strcmp(type, "play"))
        return play(s, message), true;
    while (i < sizeof types / sizeof *types && strcmp(types[i], type) != 0)
        i++;
    if (i == sizeof types / sizeof *types)
        return false;
    if (may(s, type, message, &e))
        socket_complain(s, &e);
    else
        give(s, json_pack("{ss sO}", "type", type, "message", (json_t *)message), false, NULL);
    return true;
}
