/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/homes.h"
#include "server/base/mem.h"
#include "server/net/homes_internal.h"
#include <stdlib.h>
#include <string.h>

enum { SOON_MS = 10 }; /* within which what a branch has to tell is told at once */

static const size_t PREFIX = sizeof "room:" - 1;

/* Does something to a room, which may go with it. */
static void with(struct homes *homes, struct channel *c, void (*act)(struct home *home)) {
    (void)homes;
    if (!c->home)
        return;
    channel_keep(c);
    act(c->home);
    channel_let_go(c);
}

static void each(struct homes *homes, void (*act)(struct home *home)) {
    for (struct channel *c = homes->net->rooms, *next; c; c = next) {
        next = c->next;
        with(homes, c, act);
    }
}

static void look(struct home *h) {
    if (bus_up(h->homes->bus))
        home_claim(h);
    if (h->role == HOME_ELSEWHERE && (h->stale || !h->recapped || home_now(h->homes) - h->here >= HERE_MS))
        home_here(h);
    branches_look(h);
    if (h->kept_until && h->kept_until <= home_now(h->homes)) {
        h->kept_until = 0;
        channel_let_go(h->channel);
    }
}

static void on_tick(uv_timer_t *timer) {
    struct homes *homes = timer->data;
    each(homes, look);
    orders_look(homes);
}

static void tell_stale(struct home *h) {
    if (h->role == HOME_ELSEWHERE && h->stale)
        home_here(h);
}

static void on_soon(uv_timer_t *timer) {
    each(timer->data, tell_stale);
}

static void come_back(struct home *h) {
    h->heal_by = home_now(h->homes) + HOME_HEAL_MS;
    home_claim(h);
}

static void go_alone(struct home *h) {
    home_be_alone(h);
    orders_role(h);
}

static void on_changed(void *ctx, bool up) {
    each(ctx, up ? come_back : go_alone);
}

static void on_claimed(void *ctx, const char *lease, const char *holder, uint64_t token, uint64_t asked) {
    struct homes *homes = ctx;
    struct home *h = home_find(homes, lease + PREFIX);
    if (!h && holder && !strcmp(holder, bus_name(homes->bus)))
        bus_leave(homes->bus, &(struct bus_right){lease, token}, &(struct bus_receivers){0}, "", 0);
    if (!h)
        return;
    struct channel *c = h->channel;
    channel_keep(c);
    home_claimed(h, holder, token, asked);
    orders_role(h);
    channel_let_go(c);
}

static void on_refused(void *ctx, const char *lease, uint64_t token) {
    const struct home *h = home_find(ctx, lease + PREFIX);
    if (h && h->role == HOME_HERE && h->token == token)
        home_claim(h);
}

static void on_here(struct homes *homes, struct home *h, const struct packet *p) {
    if (h && h->role == HOME_HERE)
        branches_here(h, p);
    else if (!h || h->role != HOME_SEEKING)
        home_tell(homes, p->from, packet_begin("gone", p->room));
}

static void on_heard(void *ctx, const void *data, size_t size) {
    struct homes *homes = ctx;
    struct packet p;
    if (!packet_read(data, size, &p))
        return;
    struct home *h = home_find(homes, p.room);
    struct channel *c = h ? h->channel : NULL;
    if (c)
        channel_keep(c);
    if (!strcmp(p.kind, "order"))
        orders_heard(homes, &p);
    else if (!strcmp(p.kind, "answer"))
        orders_answered(homes, &p);
    else if (!strcmp(p.kind, "here"))
        on_here(homes, h, &p);
    else if (h && !strcmp(p.kind, "gone"))
        home_claim(h);
    else if (h)
        hand_on(h, &p);
    if (c)
        channel_let_go(c);
    json_decref(p.head);
}

static void opened(struct channel *c) {
    struct homes *homes = c->net->homes;
    struct home *h = mem_alloc(sizeof *h);
    *h = (struct home){.homes = homes, .channel = c};
    c->home = h;
    if (bus_up(homes->bus))
        home_claim(h);
    else
        home_be_alone(h);
}

static void closed(struct channel *c) {
    struct home *h = c->home;
    if (h->role == HOME_HERE && bus_up(h->homes->bus))
        home_give_up(h);
    home_set_role(h, HOME_SEEKING);
    orders_forget_room(h);
    c->home = NULL;
    free(h);
}

static void tell_soon(struct channel *c, bool begin) {
    struct home *h = c->home;
    h->stale = true;
    h->begin |= begin;
    if (h->role == HOME_ELSEWHERE && !uv_is_active((uv_handle_t *)h->homes->soon))
        uv_timer_start(h->homes->soon, on_soon, SOON_MS, 0);
}

static void changed(struct channel *c) {
    tell_soon(c, false);
}

static void begin(struct channel *c) {
    tell_soon(c, true);
}

static void said(struct channel *c, struct channel_item *const *items, size_t count) {
    const struct channel_item *ours[CHANNEL_BATCH];
    size_t some = 0;
    for (size_t i = 0; i < count; i++) {
        if (!items[i]->message)
            continue;
        home_hears(c->home, items[i]);
        if (!items[i]->elsewhere)
            ours[some++] = items[i];
    }
    if (some && c->home->role == HOME_HERE)
        branches_said(c->home, ours, some);
}

static uv_timer_t *timer_new(struct homes *homes) {
    uv_timer_t *timer = mem_alloc(sizeof *timer);
    uv_timer_init(homes->net->pipeline->loop, timer);
    timer->data = homes;
    return timer;
}

struct homes *homes_open(struct net *net, struct bus *bus) {
    static const struct bus_ear ear = {on_changed, on_claimed, on_refused, on_heard};
    static const struct home_calls calls = {opened, closed, changed, begin, said};
    struct homes *homes = mem_alloc(sizeof *homes);
    *homes = (struct homes){.net = net, .bus = bus};
    homes->tick = timer_new(homes);
    homes->soon = timer_new(homes);
    uv_timer_start(homes->tick, on_tick, BUS_CLAIM_MS, BUS_CLAIM_MS);
    net->homes = homes;
    net->home_calls = &calls;
    bus_listen(bus, &ear, homes);
    return homes;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

/* The room is this daemon's alone from now on. */
static void detach(struct home *h) {
    struct channel *c = h->channel;
    bool was_elsewhere = h->role == HOME_ELSEWHERE, kept = h->kept_until;
    branches_drop(h);
    closed(c);
    if (was_elsewhere)
        channel_take(c, false);
    if (kept)
        channel_let_go(c);
}

void homes_close(struct homes *homes) {
    if (!homes)
        return;
    struct net *net = homes->net;
    bus_listen(homes->bus, NULL, NULL);
    each(homes, detach);
    orders_close(homes);
    net->homes = NULL;
    net->home_calls = NULL;
    uv_close((uv_handle_t *)homes->tick, free_timer);
    uv_close((uv_handle_t *)homes->soon, free_timer);
    free(homes);
}
