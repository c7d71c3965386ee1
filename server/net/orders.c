/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/net/order_act.h"
#include "server/net/orders_internal.h"
#include <stdlib.h>
#include <string.h>
#include <utlist.h>

enum { TRIES_AT_ONCE = 3 }; /* the next follow from the claims that are made anyway */

bool order_needed(const struct net *net, const char *room) {
    const struct channel *c = net->homes ? channel_find(net, room) : NULL;
    if (!net->homes)
        return false;
    return !c || c->home->role == HOME_SEEKING || c->home->role == HOME_ELSEWHERE;
}

/* It has left the list when its giver is called. Who gave one that is asked anew waits for no answer: that it
 * failed is told as its end. */
static void end(struct order *o, unsigned status, const json_t *answer) {
    struct channel *c = o->channel;
    struct error e;
    home_error(&e);
    if (o->again && !o->done && status >= 400)
        order_tell_failed(o, &e);
    if (c->home && status >= 400) /* whatever a home makes of it yet */
        home_told(c->home, order_number(o));
    order_done done = o->done;
    void *ctx = o->ctx;
    channel_keep(c);
    order_free(o);
    if (done)
        done(ctx, status, answer);
    channel_let_go(c);
}

/* What is to be spoken stays among the orders until its end. */
static void take(struct order *o, uint32_t utterance, unsigned status, const json_t *answer) {
    order_done done = o->done;
    void *ctx = o->ctx;
    struct channel *c = o->channel;
    o->done = NULL;
    o->utterance = utterance;
    stream_number_above(c->stream, utterance);
    if (done)
        done(ctx, status, answer);
    channel_let_go(c);
}

/* Though its answer was lost, or says that it was asked before, it may be heard here already. */
static void refuse(struct order *o, unsigned status, const json_t *answer) {
    enum { ACCEPTED = 202 };
    struct channel *c = o->channel;
    bool speaks = order_is_spoken(o);
    if (!speaks && !order_has_ended(o)) {
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

static void fail(struct order *o) {
    struct error e;
    home_error(&e);
    json_t *answer = message_error(&e);
    refuse(o, (unsigned)error_status(e.code), answer);
    json_decref(answer);
}

static uint32_t utterance_of(const json_t *answer) {
    return (uint32_t)json_integer_value(json_object_get(answer, "utterance"));
}

static void act(struct order *o) {
    unsigned status;
    json_t *answer = order_act(o->homes->net, o->channel->name, o->asked, 0, order_number(o), &status);
    json_object_del(answer, "utterance"); /* its end is told by the stream that is here */
    end(o, status, answer);
    json_decref(answer);
}

/* The one before it that the home has not answered yet, 0: none. */
static uint64_t before(const struct order *o) {
    uint64_t number = 0;
    for (const struct order *other = o->homes->orders; other != o; other = other->next)
        if (other->channel == o->channel && other->sent && !other->utterance)
            number = other->number;
    return number;
}

/* The home does not do it before that which it comes after. */
static void send_order(struct order *o) {
    const struct home *h = o->channel->home;
    json_t *head = packet_begin("order", o->channel->name);
    json_object_set_new(head, "number", json_integer((json_int_t)o->number));
    json_object_set_new(head, "after", json_integer((json_int_t)before(o)));
    json_object_set_new(head, "token", json_integer((json_int_t)h->token));
    json_object_set_new(head, "visit", json_integer(h->visit));
    json_object_set(head, "order", o->asked);
    home_tell(o->homes, h->holder, head);
    o->sent = true;
}

/* As the role of its room is now. */
static void go_on(struct order *o) {
    switch (o->channel->home->role) {
    case HOME_ELSEWHERE:
        if (!o->sent)
            send_order(o);
        break;
    case HOME_HERE:
    case HOME_ALONE:
        if (o->sent) /* to a home that is gone: nobody knows whether it was done */
            fail(o);
        else
            act(o);
        break;
    default:
        break;
    }
}

struct order *order_give(struct net *net, const char *room, json_t *asked, order_done done, void *ctx) {
    struct error e;
    struct channel *c =
        channel_room(net, room, (uint32_t)json_integer_value(json_object_get(asked, "payer")), &e);
    if (!c) {
        json_t *answer = message_error(&e);
        done(ctx, (unsigned)error_status(e.code), answer);
        json_decref(answer);
        json_decref(asked);
        return NULL;
    }
    struct homes *homes = net->homes;
    struct order *o = mem_alloc(sizeof *o);
    *o = (struct order){.homes = homes,
                        .channel = c,
                        .number = ++homes->order_number,
                        .until = home_now(homes) + ORDER_MS,
                        .asked = asked,
                        .done = done,
                        .ctx = ctx};
    channel_keep(c);
    DL_APPEND(homes->orders, o);
    uint64_t number = o->number;
    channel_keep(c);
    orders_role(c->home); /* those before it that wait, too, and first */
    channel_let_go(c);
    return homes->orders && homes->orders->prev->number == number ? homes->orders->prev : NULL;
}

void order_forget(struct order *o) {
    if (o)
        o->done = NULL;
}

/* Those that fit, each once, whatever the ends of others do to the list. */
static struct order *next_after(const struct homes *homes, uint64_t number, const struct channel *c) {
    struct order *o = homes->orders;
    while (o && (o->utterance || o->number <= number || (c && o->channel != c)))
        o = o->next;
    return o;
}

void orders_role(struct home *h) {
    struct homes *homes = h->homes;
    const struct channel *c = h->channel;
    uint64_t number = 0;
    for (struct order *o; (o = next_after(homes, number, c));) {
        number = o->number;
        go_on(o);
    }
}

void orders_look(struct homes *homes) {
    uint64_t number = 0;
    for (struct order *o; (o = next_after(homes, number, NULL));) {
        number = o->number;
        if (o->until <= home_now(homes))
            fail(o);
    }
}

void orders_close(struct homes *homes) {
    for (struct order *o; (o = next_after(homes, 0, NULL));)
        fail(o);
}

void orders_heard(struct homes *homes, const struct packet *p) {
    struct home *h = home_find(homes, p->room);
    json_t *asked = json_object_get(p->head, "order"), *head = packet_begin("answer", p->room);
    unsigned status = 0;
    json_object_set(head, "number", json_object_get(p->head, "number"));
    json_object_set(head, "token", json_object_get(p->head, "token"));
    json_object_set(head, "visit", json_object_get(p->head, "visit"));
    /* asked under another token, it has been given up by who asked */
    bool here = h && h->role == HOME_HERE && json_is_object(asked) && packet_number(p, "token") == h->token;
    uint64_t order = home_order(p->from, packet_number(p, "number")), after = packet_number(p, "after");
    here &= !after || home_has_done(h, home_order(p->from, after));
    if (here)
        home_does(h, order);
    bool heard = here && (home_has_heard(h, order) || channel_order(h->channel) == order);
    if (heard) {
        struct error e;
        home_error(&e);
        status = (unsigned)error_status(e.code);
        json_object_set_new(head, "answer", message_error(&e));
    } else if (here) {
        json_object_set_new(head, "answer",
                            order_act(homes->net, p->room, asked, home_abroad(p), order, &status));
    }
    json_object_set_new(head, "status", json_integer(status));
    home_tell(homes, p->from, head);
}

void orders_answered(struct homes *homes, const struct packet *p) {
    uint64_t number = packet_number(p, "number"), status = packet_number(p, "status");
    struct order *o = homes->orders;
    while (o && o->number != number)
        o = o->next;
    json_t *answer = json_object_get(p->head, "answer");
    uint32_t utterance = utterance_of(answer);
    json_object_del(answer, "utterance");
    struct home *h = home_find(homes, p->room);
    bool known = h && o && o->channel == h->channel && packet_number(p, "visit") == h->visit;
    bool current = h && h->role == HOME_ELSEWHERE && packet_number(p, "token") == h->token;
    if (current && utterance && !known) {
        home_is_past(h, utterance); /* that order has been told to be lost, or given anew */
    } else if (!current || !known || o->utterance || !o->sent) {
        return; /* a late one, of a home that was lost */
    } else if (o && status && utterance && !order_has_ended(o)) {
        take(o, utterance, (unsigned)status, answer);
    } else if (o && status >= 400) {
        refuse(o, (unsigned)status, answer);
    } else if (o && status) {
        end(o, (unsigned)status, answer);
    } else if (o) { /* it is not the home, and did nothing: who is? */
        o->sent = false;
        if (o->tries++ < TRIES_AT_ONCE)
            home_claim(o->channel->home);
    }
}
