/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forwards commands for rooms that another daemon leads, or may lead. Keeps each command until it is answered
 * and the speech that it requested has ended. If the leader is lost, its speech is lost too: this daemon then
 * sends the end event, or repeats the command to the next leader if the client asked for that (`again`).
 * Commands stay in the order in which clients sent them to this daemon. */
#include "server/base/json/error_json.h"
#include "server/base/mem.h"
#include "server/rooms/shared/shared_internal.h"
#include <stdlib.h>
#include <string.h>
#include <utlist.h>

enum { TRIES_AT_ONCE = 3 }; /* later tries follow the periodic claims */

bool forward_needed(const struct rooms *rooms, const char *room) {
    const struct channel *c = rooms->shared ? channel_find(rooms, room) : NULL;
    if (!rooms->shared)
        return false;
    return !c || c->shared->role == ROLE_SEEKING || c->shared->role == ROLE_REPLICA;
}

static void forward_free(struct forward *o);

static uint64_t forward_number(const struct forward *o);

static void forward_tell_failed(const struct forward *o, const struct error *e);

/* Removes the command before calling its callback. A command that was sent again has no caller waiting, so
 * its failure is sent as the end of its utterance. */
static void end(struct forward *o, unsigned status, const json_t *answer) {
    struct channel *c = o->channel;
    struct error e;
    shared_error(&e);
    if (o->again && !o->done && status >= 400)
        forward_tell_failed(o, &e);
    if (c->shared && status >= 400) /* even if a leader runs it later */
        shared_note_ended(c->shared, forward_number(o));
    forward_done done = o->done;
    void *ctx = o->ctx;
    channel_keep(c);
    forward_free(o);
    if (done)
        done(ctx, status, answer);
    channel_let_go(c);
}

/* Records that the leader accepted the command, and keeps it until the end of its utterance. */
static void take(struct forward *o, uint32_t utterance, unsigned status, const json_t *answer) {
    forward_done done = o->done;
    void *ctx = o->ctx;
    struct channel *c = o->channel;
    o->done = NULL;
    o->utterance = utterance;
    stream_number_above(c->stream, utterance);
    if (done)
        done(ctx, status, answer);
    channel_let_go(c);
}

static bool forward_is_spoken(const struct forward *o);

static bool forward_has_ended(const struct forward *o);

/* Fails the command, unless its speech is heard or has ended here: the answer may have been lost, or say
 * that the command was run before. */
static void refuse(struct forward *o, unsigned status, const json_t *answer) {
    enum { ACCEPTED = 202 };
    struct channel *c = o->channel;
    bool speaks = forward_is_spoken(o);
    if (!speaks && !forward_has_ended(o)) {
        end(o, status, answer);
        return;
    }
    json_t *accepted = json_pack("{ss ss}", "type", "accepted", "room", c->name);
    if (speaks)
        take(o, channel_utterance(c), ACCEPTED, accepted);
    else
        end(o, ACCEPTED, accepted);
    json_decref(accepted);
}

static void fail(struct forward *o) {
    struct error e;
    shared_error(&e);
    json_t *answer = error_json(&e);
    refuse(o, (unsigned)error_status(e.code), answer);
    json_decref(answer);
}

static uint32_t utterance_of(const json_t *answer) {
    return (uint32_t)json_integer_value(json_object_get(answer, "utterance"));
}

static void act(struct forward *o) {
    unsigned status;
    json_t *answer =
        o->all->rooms->run(o->all->rooms->ctx, o->channel->name, o->asked, 0, forward_number(o), &status);
    json_object_del(answer, "utterance"); /* the local stream sends its end */
    end(o, status, answer);
    json_decref(answer);
}

/* The last earlier command for the room that the leader has not answered yet, 0: none. */
static uint64_t before(const struct forward *o) {
    uint64_t number = 0;
    for (const struct forward *other = o->all->forwards; other != o; other = other->next)
        if (other->channel == o->channel && other->sent && !other->utterance)
            number = other->number;
    return number;
}

/* Sends the command to the leader, which does not run it before the command that it comes after. */
static void send_command(struct forward *o) {
    const struct shared_room *h = o->channel->shared;
    json_t *head = packet_begin("command", o->channel->name);
    json_object_set_new(head, "number", json_integer((json_int_t)o->number));
    json_object_set_new(head, "after", json_integer((json_int_t)before(o)));
    json_object_set_new(head, "token", json_integer((json_int_t)h->token));
    json_object_set_new(head, "visit", json_integer(h->visit));
    json_object_set(head, "command", o->asked);
    shared_tell(o->all, h->holder, head);
    o->sent = true;
}

/* Proceeds according to the present role of the command's room. */
static void go_on(struct forward *o) {
    switch (o->channel->shared->role) {
    case ROLE_REPLICA:
        if (!o->sent)
            send_command(o);
        break;
    case ROLE_LEADER:
    case ROLE_ALONE:
        if (o->sent) /* to a leader that is lost: it may or may not have run */
            fail(o);
        else
            act(o);
        break;
    default:
        break;
    }
}

struct forward *forward_command(struct rooms *rooms, const char *room, json_t *asked, forward_done done,
                                void *ctx) {
    struct error e;
    struct channel *c =
        channel_room(rooms, room, (uint32_t)json_integer_value(json_object_get(asked, "quota-key")), &e);
    if (!c) {
        json_t *answer = error_json(&e);
        done(ctx, (unsigned)error_status(e.code), answer);
        json_decref(answer);
        json_decref(asked);
        return NULL;
    }
    struct shared_rooms *all = rooms->shared;
    struct forward *o = mem_alloc(sizeof *o);
    *o = (struct forward){.all = all,
                          .channel = c,
                          .number = ++all->forward_number,
                          .until = shared_now(all) + FORWARD_MS,
                          .asked = asked,
                          .done = done,
                          .ctx = ctx};
    channel_keep(c);
    DL_APPEND(all->forwards, o);
    uint64_t number = o->number;
    channel_keep(c);
    forwards_role(c->shared); /* earlier commands of the room that still wait go first */
    channel_let_go(c);
    return all->forwards && all->forwards->prev->number == number ? all->forwards->prev : NULL;
}

void forward_forget(struct forward *o) {
    if (o)
        o->done = NULL;
}

/* The next waiting command after `number`, in room c or (NULL) in any. Safe while callbacks change the
 * list. */
static struct forward *next_after(const struct shared_rooms *all, uint64_t number, const struct channel *c) {
    struct forward *o = all->forwards;
    while (o && (o->utterance || o->number <= number || (c && o->channel != c)))
        o = o->next;
    return o;
}

void forwards_role(struct shared_room *h) {
    struct shared_rooms *all = h->all;
    const struct channel *c = h->channel;
    uint64_t number = 0;
    for (struct forward *o; (o = next_after(all, number, c));) {
        number = o->number;
        go_on(o);
    }
}

void forwards_expire(struct shared_rooms *all) {
    uint64_t number = 0;
    for (struct forward *o; (o = next_after(all, number, NULL));) {
        number = o->number;
        if (o->until <= shared_now(all))
            fail(o);
    }
}

void forwards_close(struct shared_rooms *all) {
    for (struct forward *o; (o = next_after(all, 0, NULL));)
        fail(o);
}

void forwards_heard(struct shared_rooms *all, const struct packet *p) {
    struct shared_room *h = shared_find(all, p->room);
    json_t *asked = json_object_get(p->head, "command"), *head = packet_begin("answer", p->room);
    unsigned status = 0;
    json_object_set(head, "number", json_object_get(p->head, "number"));
    json_object_set(head, "token", json_object_get(p->head, "token"));
    json_object_set(head, "visit", json_object_get(p->head, "visit"));
    /* a command sent under another token was given up by its sender */
    bool here = h && h->role == ROLE_LEADER && json_is_object(asked) && packet_number(p, "token") == h->token;
    uint64_t command = shared_command(p->from, packet_number(p, "number")), after = packet_number(p, "after");
    here &= !after || shared_has_done(h, shared_command(p->from, after));
    if (here)
        shared_note_done(h, command);
    bool heard = here && (shared_has_heard(h, command) || channel_command(h->channel) == command);
    if (heard) {
        struct error e;
        shared_error(&e);
        status = (unsigned)error_status(e.code);
        json_object_set_new(head, "answer", error_json(&e));
    } else if (here) {
        json_object_set_new(
            head, "answer",
            all->rooms->run(all->rooms->ctx, p->room, asked, shared_origin(p), command, &status));
    }
    json_object_set_new(head, "status", json_integer(status));
    shared_tell(all, p->from, head);
}

void forwards_answered(struct shared_rooms *all, const struct packet *p) {
    uint64_t number = packet_number(p, "number"), status = packet_number(p, "status");
    struct forward *o = all->forwards;
    while (o && o->number != number)
        o = o->next;
    json_t *answer = json_object_get(p->head, "answer");
    uint32_t utterance = utterance_of(answer);
    json_object_del(answer, "utterance");
    struct shared_room *h = shared_find(all, p->room);
    bool known = h && o && o->channel == h->channel && packet_number(p, "visit") == h->visit;
    bool current = h && h->role == ROLE_REPLICA && packet_number(p, "token") == h->token;
    if (current && utterance && !known) {
        shared_is_past(h, utterance); /* the command was already reported as lost, or sent again */
    } else if (!current || !known || o->utterance || !o->sent) {
        return; /* late answer of a leader that was lost */
    } else if (o && status && utterance && !forward_has_ended(o)) {
        take(o, utterance, (unsigned)status, answer);
    } else if (o && status >= 400) {
        refuse(o, (unsigned)status, answer);
    } else if (o && status) {
        end(o, (unsigned)status, answer);
    } else if (o) { /* not the leader, and it did nothing: find the leader */
        o->sent = false;
        if (o->tries++ < TRIES_AT_ONCE)
            shared_claim(o->channel->shared);
    }
}

/* Removes the command from the list and frees it. */
static void forward_free(struct forward *o) {
    DL_DELETE(o->all->forwards, o);
    json_decref(o->asked);
    if (!o->utterance)
        channel_let_go(o->channel);
    free(o);
}

static const json_t *request_of(const struct forward *o) {
    return json_object_get(o->asked, "request");
}

/* Its cluster-wide number (shared_command). */
static uint64_t forward_number(const struct forward *o) {
    return shared_command(bus_name(o->all->bus), o->number);
}

static bool forward_is_spoken(const struct forward *o) {
    return o->channel->shared && channel_command(o->channel) == forward_number(o);
}

/* Returns whether its utterance has ended for local followers, or its end is about to be sent, even if the
 * leader has not answered. */
static bool forward_has_ended(const struct forward *o) {
    return o->channel->shared && shared_has_heard(o->channel->shared, forward_number(o));
}

/* Returns whether its speech must be repeated if the leader is lost. */
static bool forward_is_again(const struct forward *o) {
    return json_is_true(json_object_get(request_of(o), "again"));
}

/* Sends an error and the end of its utterance to local followers. */
static void forward_tell_failed(const struct forward *o, const struct error *e) {
    struct stream_event event = {.kind = STREAM_ERROR,
                                 .utterance = o->utterance,
                                 .id = json_string_value(json_object_get(request_of(o), "id")),
                                 .command = forward_number(o),
                                 .error = e,
                                 .reason = "failed",
                                 .idle = -1};
    channel_sink.event(o->channel, &event);
    event.kind = STREAM_END;
    channel_sink.event(o->channel, &event);
}

static struct forward *find(const struct shared_room *h, uint32_t utterance) {
    struct forward *o = h->all->forwards;
    while (o && (o->channel != h->channel || !o->utterance || o->utterance != utterance))
        o = o->next;
    return o;
}

void forwards_ended(struct shared_room *h, uint32_t utterance) {
    struct forward *o = find(h, utterance);
    if (o)
        forward_free(o);
}

bool forwards_again(const struct shared_room *h, uint32_t utterance) {
    const struct forward *o = find(h, utterance);
    return o && forward_is_again(o);
}

/* Makes the command wait for the next leader. */
static void ask_again(struct forward *o) {
    if (o->utterance)
        channel_keep(o->channel);
    o->utterance = 0;
    o->sent = false;
    o->again = true;
    o->tries = 0;
    o->until = shared_now(o->all) + FORWARD_MS;
}

void forwards_lost(struct shared_room *h, uint32_t told, bool again, const struct error *e) {
    for (struct forward *o = h->all->forwards, *next; o; o = next) {
        next = o->next;
        if (o->channel != h->channel || (!o->utterance && !o->sent))
            continue;
        if (o->utterance)
            shared_is_past(h, o->utterance);
        if (again && forward_is_again(o) && !forward_has_ended(o)) {
            ask_again(o);
        } else if (!o->utterance) {
            o->until = 0; /* it may or may not have run */
        } else {
            if (o->utterance != told)
                forward_tell_failed(o, e);
            forward_free(o);
        }
    }
}

void forwards_forget_room(struct shared_room *h) {
    for (struct forward *o = h->all->forwards, *next; o; o = next) {
        next = o->next;
        if (o->channel == h->channel && o->utterance)
            forward_free(o);
    }
}
