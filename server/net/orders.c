/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/orders.h"
#include "server/base/mem.h"
#include "server/net/homes_internal.h"
#include "server/net/order_act.h"
#include <stdlib.h>
#include <string.h>
#include <utlist.h>

enum { TRIES_AT_ONCE = 3 }; /* the next follow from the claims that are made anyway */

struct order {
    struct order *prev, *next;
    struct homes *homes;
    struct channel *channel; /* kept */
    uint64_t number;
    uint64_t until; /* loop time */
    json_t *asked;
    bool sent;
    unsigned tries;
    order_done done; /* NULL: nobody waits */
    void *ctx;
};

bool order_needed(const struct net *net, const char *room) {
    const struct channel *c = net->homes ? channel_find(net, room) : NULL;
    if (!net->homes)
        return false;
    return !c || c->home->role == HOME_SEEKING || c->home->role == HOME_ELSEWHERE;
}

/* It has left the list when its giver is called. */
static void end(struct order *o, unsigned status, const json_t *answer) {
    DL_DELETE(o->homes->orders, o);
    if (o->done)
        o->done(o->ctx, status, answer);
    json_decref(o->asked);
    channel_let_go(o->channel);
    free(o);
}

static void fail(struct order *o) {
    struct error e;
    home_error(&e);
    json_t *answer = message_error(&e);
    end(o, (unsigned)error_status(e.code), answer);
    json_decref(answer);
}

static void act(struct order *o) {
    unsigned status;
    json_t *answer = order_act(o->homes->net, o->channel->name, o->asked, &status);
    json_object_del(answer, "utterance"); /* its end is told by the stream that is here */
    end(o, status, answer);
    json_decref(answer);
}

static void send_order(struct order *o) {
    const struct home *h = o->channel->home;
    json_t *head = packet_begin("order", o->channel->name);
    json_object_set_new(head, "number", json_integer((json_int_t)o->number));
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
    struct channel *c = channel_room(net, room, &e);
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
    go_on(o);
    return homes->orders && homes->orders->prev->number == number ? homes->orders->prev : NULL;
}

void order_forget(struct order *o) {
    if (o)
        o->done = NULL;
}

/* Those that fit, each once, whatever the ends of others do to the list. */
static struct order *next_after(const struct homes *homes, uint64_t number, const struct channel *c) {
    struct order *o = homes->orders;
    while (o && (o->number <= number || (c && o->channel != c)))
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
    while (homes->orders)
        fail(homes->orders);
}

void orders_heard(struct homes *homes, const struct packet *p) {
    struct home *h = home_find(homes, p->room);
    json_t *asked = json_object_get(p->head, "order"), *head = packet_begin("answer", p->room);
    unsigned status = 0;
    json_object_set(head, "number", json_object_get(p->head, "number"));
    if (h && h->role == HOME_HERE && json_is_object(asked))
        json_object_set_new(head, "answer", order_act(homes->net, p->room, asked, &status));
    json_object_set_new(head, "status", json_integer(status));
    home_tell(homes, p->from, head);
}

static void take_utterance(const struct order *o, json_t *answer) {
    const json_t *utterance = json_object_get(answer, "utterance");
    const json_t *request = json_object_get(o->asked, "request");
    if (utterance)
        home_waits(o->channel->home, (uint32_t)json_integer_value(utterance),
                   json_string_value(json_object_get(request, "id")));
    json_object_del(answer, "utterance");
}

void orders_answered(struct homes *homes, const struct packet *p) {
    uint64_t number = packet_number(p, "number"), status = packet_number(p, "status");
    struct order *o = homes->orders;
    while (o && o->number != number)
        o = o->next;
    json_t *answer = json_object_get(p->head, "answer");
    if (o && status) {
        take_utterance(o, answer);
        end(o, (unsigned)status, answer);
    } else if (o) { /* it is not the home, and did nothing: who is? */
        o->sent = false;
        if (o->tries++ < TRIES_AT_ONCE)
            home_claim(o->channel->home);
    }
}
