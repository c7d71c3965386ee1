/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The side that speaks: says whose voices it has, takes sentences and keeps hold of them. */
#include "server/base/mem.h"
#include "server/cluster/redis_hands_internal.h"
#include "server/cluster/redis_work_scripts.h"
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

enum { NUMBER_BYTES = 16 };

static void on_nothing(void *ctx, const redisReply *reply) {
    (void)ctx;
    redis_work_well(reply);
}

static void announce(struct redis_hands *h, const struct work_offer *offer, bool tell, link_answered answered,
                     void *ctx) {
    char ms[NUMBER_BYTES];
    snprintf(ms, sizeof ms, "%d", WORK_ANNOUNCE_MS);
    const struct link_text more[] = {link_text_of(offer->source.queue), link_text_of(offer->source.plugin),
                                     link_text_of(ms), link_text_of(offer->source.voices)};
    redis_work_run(h->mouth, tell ? SCRIPT_WORK_TELL : SCRIPT_WORK_ANNOUNCE, more, tell ? 4 : 3, answered,
                   ctx);
}

/* One that Redis does not know of is told in full; which one does not matter, as all are few. */
static void on_announced(void *ctx, const redisReply *reply) {
    struct redis_hands *h = ctx;
    const struct work_offer *offers;
    if (!redis_work_well(reply) || h->closed || reply->type != REDIS_REPLY_INTEGER || reply->integer)
        return;
    size_t count = h->events.offers(h->ctx, &offers);
    for (size_t i = 0; i < count; i++)
        announce(h, &offers[i], true, on_nothing, NULL);
}

static void on_renewed(void *ctx, const redisReply *reply) {
    struct redis_hands *h = ctx;
    if (!redis_work_well(reply) || h->closed || reply->type != REDIS_REPLY_ARRAY)
        return;
    for (size_t i = 0; i < reply->elements; i++) {
        struct redis_item *item, *next;
        DL_FOREACH_SAFE(h->items, item, next)
        if (!strcmp(item->name, redis_work_text(reply, i))) {
            h->events.lost(h->ctx, &item->item);
            redis_hands_free_item(item);
            break;
        }
    }
    if (reply->elements)
        redis_hands_take(h);
}

static void renew(struct redis_hands *h) {
    struct redis_item *item;
    struct buf names = {0};
    DL_FOREACH(h->items, item)
    buf_printf(&names, "%s ", item->name);
    if (names.size)
        redis_work_run(h->mouth, SCRIPT_WORK_RENEW,
                       (struct link_text[]){link_text_of(h->id), {names.data, names.size}}, 2, on_renewed, h);
    buf_free(&names);
}

static void listen_on(struct redis_hands *h);

static void on_pulse(uv_timer_t *timer) {
    struct redis_hands *h = timer->data;
    const struct work_offer *offers;
    size_t count = h->events.offers(h->ctx, &offers);
    for (size_t i = 0; i < count; i++)
        announce(h, &offers[i], false, on_announced, h);
    renew(h);
    listen_on(h);
}

static void look(struct work_hands *hands) {
    struct redis_hands *h = (struct redis_hands *)hands;
    if (!h->taking)
        h->cursor = 0;
    redis_hands_take(h);
}

/* ---- the bell ---- */

static void on_bell(void *ctx, const redisReply *reply) {
    struct redis_hands *h = ctx;
    h->listening = false;
    if (!reply || h->closed)
        return;
    bool well = reply->type == REDIS_REPLY_NIL;
    if (reply->type == REDIS_REPLY_ARRAY && reply->elements == 1 &&
        reply->element[0]->type == REDIS_REPLY_ARRAY && reply->element[0]->elements == 2) {
        const redisReply *entries = reply->element[0]->element[1];
        const char *id = entries->type == REDIS_REPLY_ARRAY && entries->elements
                             ? redis_work_text(entries->element[entries->elements - 1], 0)
                             : "";
        snprintf(h->bell, sizeof h->bell, "%s", *id ? id : "$");
        well = *id;
        renew(h);
    } else {
        redis_work_well(reply);
    }
    look(&h->hands); /* in silence, too: what somebody has lost rings no bell */
    if (well)        /* otherwise at the next pulse: nonsense that comes at once is not asked for at once */
        listen_on(h);
}

static void listen_on(struct redis_hands *h) {
    char ms[NUMBER_BYTES];
    snprintf(ms, sizeof ms, "%d", WORK_LISTEN_MS);
    const struct link_text words[] = {link_text_of("XREAD"),
                                      link_text_of("BLOCK"),
                                      link_text_of(ms),
                                      link_text_of("STREAMS"),
                                      link_text_of(REDIS_WORK ":bell"),
                                      link_text_of(h->bell)};
    h->listening = h->listening || redis_link_send(h->ear, words, 6, on_bell, h);
}

static void on_mouth(void *ctx, bool up) {
    struct redis_hands *h = ctx;
    if (up)
        uv_timer_start(&h->pulse, on_pulse, 0, WORK_LOOK_MS);
    else
        uv_timer_stop(&h->pulse);
}

static void on_ear(void *ctx, bool up) {
    struct redis_hands *h = ctx;
    strcpy(h->bell, "$");
    if (up)
        listen_on(h);
}

/* ---- */

static void answer(struct work_item *item, enum work_end end, const struct buf *body) {
    redis_hands_answer((struct redis_item *)item, end, body);
}

static void give_back(struct work_item *item) {
    struct redis_item *i = (struct redis_item *)item;
    struct redis_hands *h = (struct redis_hands *)item->hands;
    redis_work_run(h->mouth, SCRIPT_WORK_GIVE_BACK,
                   (struct link_text[]){link_text_of(h->id), link_text_of(i->key), link_text_of(i->id)}, 3,
                   on_nothing, NULL);
    redis_hands_free_item(i);
}

static void on_closed(uv_handle_t *handle) {
    free(handle->data);
}

static void close_hands(struct work_hands *hands) {
    struct redis_hands *h = (struct redis_hands *)hands;
    h->closed = true;
    while (h->items)
        redis_hands_free_item(h->items);
    redis_link_close(h->mouth);
    redis_link_close(h->ear);
    uv_close((uv_handle_t *)&h->pulse, on_closed);
}

static const struct work_hands_engine engine = {look, answer, give_back, close_hands};

struct work_hands *redis_hands_open(uv_loop_t *loop, const char *address,
                                    const struct work_hands_events *events, void *ctx, struct error *e) {
    struct redis_hands *h = mem_alloc(sizeof *h);
    h->hands.engine = &engine;
    h->loop = loop;
    h->events = *events;
    h->ctx = ctx;
    redis_id_make(h->id);
    strcpy(h->bell, "$");
    h->mouth = redis_work_link(loop, address, "work", on_mouth, h, e);
    h->ear = h->mouth ? redis_work_link(loop, address, "bell", on_ear, h, e) : NULL;
    if (!h->ear) {
        free(h);
        return NULL;
    }
    uv_timer_init(loop, &h->pulse);
    h->pulse.data = h;
    return &h->hands;
}
