/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was ordered in a branch, and has been taken by the home, until its end comes from there. When the home
 * is lost, so is what waited: the daemon at which it was asked for tells its end, or asks the next home for
 * it where that was wished. All keep the order in which they were asked for here. */
#include "server/net/orders_internal.h"
#include <stdlib.h>
#include <utlist.h>

void order_free(struct order *o) {
    DL_DELETE(o->homes->orders, o);
    json_decref(o->asked);
    if (!o->utterance)
        channel_let_go(o->channel);
    free(o);
}

static const json_t *request_of(const struct order *o) {
    return json_object_get(o->asked, "request");
}

uint64_t order_number(const struct order *o) {
    return home_order(bus_name(o->homes->bus), o->number);
}

bool order_is_spoken(const struct order *o) {
    return o->channel->home && channel_order(o->channel) == order_number(o);
}

bool order_has_ended(const struct order *o) {
    return o->channel->home && home_has_heard(o->channel->home, order_number(o));
}

bool order_is_again(const struct order *o) {
    return json_is_true(json_object_get(request_of(o), "again"));
}

void order_tell_failed(const struct order *o, const struct error *e) {
    struct stream_event event = {.kind = STREAM_ERROR,
                                 .utterance = o->utterance,
                                 .id = json_string_value(json_object_get(request_of(o), "id")),
                                 .order = order_number(o),
                                 .error = e,
                                 .reason = "failed",
                                 .idle = -1};
    channel_sink.event(o->channel, &event);
    event.kind = STREAM_END;
    channel_sink.event(o->channel, &event);
}

static struct order *find(const struct home *h, uint32_t utterance) {
    struct order *o = h->homes->orders;
    while (o && (o->channel != h->channel || !o->utterance || o->utterance != utterance))
        o = o->next;
    return o;
}

void orders_ended(struct home *h, uint32_t utterance) {
    struct order *o = find(h, utterance);
    if (o)
        order_free(o);
}

bool orders_again(const struct home *h, uint32_t utterance) {
    const struct order *o = find(h, utterance);
    return o && order_is_again(o);
}

/* It waits for the next home, from now on. */
static void ask_again(struct order *o) {
    if (o->utterance)
        channel_keep(o->channel);
    o->utterance = 0;
    o->sent = false;
    o->again = true;
    o->tries = 0;
    o->until = home_now(o->homes) + ORDER_MS;
}

void orders_lost(struct home *h, uint32_t told, bool again, const struct error *e) {
    for (struct order *o = h->homes->orders, *next; o; o = next) {
        next = o->next;
        if (o->channel != h->channel || (!o->utterance && !o->sent))
            continue;
        if (o->utterance)
            home_is_past(h, o->utterance);
        if (again && order_is_again(o) && !order_has_ended(o)) {
            ask_again(o);
        } else if (!o->utterance) {
            o->until = 0; /* nobody knows whether it was done */
        } else {
            if (o->utterance != told)
                order_tell_failed(o, e);
            order_free(o);
        }
    }
}

void orders_forget_room(struct home *h) {
    for (struct order *o = h->homes->orders, *next; o; o = next) {
        next = o->next;
        if (o->channel == h->channel && o->utterance)
            order_free(o);
    }
}
