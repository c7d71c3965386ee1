/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/rooms/shared/shared_internal.h"
#include <stdlib.h>
#include <string.h>

enum { SOON_MS = 10 }; /* ms to collect changes before a replica reports them */

static const size_t PREFIX = sizeof "room:" - 1;

/* Calls act on a shared room; act may remove the room. */
static void with(struct shared_rooms *all, struct channel *c, void (*act)(struct shared_room *room)) {
    (void)all;
    if (!c->shared)
        return;
    channel_keep(c);
    act(c->shared);
    channel_let_go(c);
}

static void each(struct shared_rooms *all, void (*act)(struct shared_room *room)) {
    for (struct channel *c = all->rooms->list, *next; c; c = next) {
        next = c->next;
        with(all, c, act);
    }
}

static void look(struct shared_room *h) {
    if (bus_up(h->all->bus))
        shared_claim(h);
    if (h->role == ROLE_REPLICA && (h->stale || !h->recapped || shared_now(h->all) - h->here >= HERE_MS))
        shared_report(h);
    replicas_look(h);
    if (h->kept_until && h->kept_until <= shared_now(h->all)) {
        h->kept_until = 0;
        channel_let_go(h->channel);
    }
}

static void on_tick(uv_timer_t *timer) {
    struct shared_rooms *all = timer->data;
    each(all, look);
    forwards_expire(all);
}

static void tell_stale(struct shared_room *h) {
    if (h->role == ROLE_REPLICA && h->stale)
        shared_report(h);
}

static void on_soon(uv_timer_t *timer) {
    each(timer->data, tell_stale);
}

static void come_back(struct shared_room *h) {
    h->heal_by = shared_now(h->all) + SPLIT_MS;
    shared_claim(h);
}

static void go_alone(struct shared_room *h) {
    shared_be_alone(h);
    forwards_role(h);
}

static void on_changed(void *ctx, bool up) {
    each(ctx, up ? come_back : go_alone);
}

static void on_claimed(void *ctx, const char *lease, const char *holder, uint64_t token, uint64_t asked) {
    struct shared_rooms *all = ctx;
    struct shared_room *h = shared_find(all, lease + PREFIX);
    if (!h && holder && !strcmp(holder, bus_name(all->bus)))
        bus_leave(all->bus, &(struct bus_right){lease, token}, &(struct bus_receivers){0}, "", 0);
    if (!h)
        return;
    struct channel *c = h->channel;
    channel_keep(c);
    shared_claimed(h, holder, token, asked);
    forwards_role(h);
    channel_let_go(c);
}

static void on_refused(void *ctx, const char *lease, uint64_t token) {
    const struct shared_room *h = shared_find(ctx, lease + PREFIX);
    if (h && h->role == ROLE_LEADER && h->token == token)
        shared_claim(h);
}

static void on_here(struct shared_rooms *all, struct shared_room *h, const struct packet *p) {
    if (h && h->role == ROLE_LEADER)
        replicas_report(h, p);
    else if (!h || h->role != ROLE_SEEKING)
        shared_tell(all, p->from, packet_begin("gone", p->room));
}

static void on_heard(void *ctx, const void *data, size_t size) {
    struct shared_rooms *all = ctx;
    struct packet p;
    if (!packet_read(data, size, &p))
        return;
    struct shared_room *h = shared_find(all, p.room);
    struct channel *c = h ? h->channel : NULL;
    if (c)
        channel_keep(c);
    if (!strcmp(p.kind, "command"))
        forwards_heard(all, &p);
    else if (!strcmp(p.kind, "answer"))
        forwards_answered(all, &p);
    else if (!strcmp(p.kind, "here"))
        on_here(all, h, &p);
    else if (h && !strcmp(p.kind, "gone"))
        shared_claim(h);
    else if (h)
        replicate(h, &p);
    if (c)
        channel_let_go(c);
    json_decref(p.head);
}

static void opened(struct channel *c) {
    struct shared_rooms *all = c->rooms->shared;
    struct shared_room *h = mem_alloc(sizeof *h);
    *h = (struct shared_room){.all = all, .channel = c};
    c->shared = h;
    if (bus_up(all->bus))
        shared_claim(h);
    else
        shared_be_alone(h);
}

static void closed(struct channel *c) {
    struct shared_room *h = c->shared;
    if (h->role == ROLE_LEADER && bus_up(h->all->bus))
        shared_give_up(h);
    shared_set_role(h, ROLE_SEEKING);
    forwards_forget_room(h);
    c->shared = NULL;
    free(h);
}

static void tell_soon(struct channel *c, bool begin) {
    struct shared_room *h = c->shared;
    h->stale = true;
    h->begin |= begin;
    if (h->role == ROLE_REPLICA && !uv_is_active((uv_handle_t *)h->all->soon))
        uv_timer_start(h->all->soon, on_soon, SOON_MS, 0);
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
        shared_note_heard(c->shared, items[i]);
        if (!items[i]->remote)
            ours[some++] = items[i];
    }
    if (some && c->shared->role == ROLE_LEADER)
        replicas_said(c->shared, ours, some);
}

static uv_timer_t *timer_new(struct shared_rooms *all) {
    uv_timer_t *timer = mem_alloc(sizeof *timer);
    uv_timer_init(all->rooms->pipeline->loop, timer);
    timer->data = all;
    return timer;
}

void rooms_share(struct rooms *rooms, struct bus *bus) {
    static const struct bus_ear ear = {on_changed, on_claimed, on_refused, on_heard};
    static const struct sharing_calls calls = {opened, closed, changed, begin, shared_keep, said};
    struct shared_rooms *all = mem_alloc(sizeof *all);
    *all = (struct shared_rooms){.rooms = rooms, .bus = bus};
    all->tick = timer_new(all);
    all->soon = timer_new(all);
    uv_timer_start(all->tick, on_tick, BUS_CLAIM_MS, BUS_CLAIM_MS);
    rooms->shared = all;
    rooms->sharing_calls = &calls;
    bus_listen(bus, &ear, all);
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

/* Stops sharing the room: this daemon has it alone. */
static void detach(struct shared_room *h) {
    struct channel *c = h->channel;
    bool was_elsewhere = h->role == ROLE_REPLICA, kept = h->kept_until;
    replicas_drop(h);
    closed(c);
    if (was_elsewhere)
        channel_take(c, false);
    if (kept)
        channel_let_go(c);
}

void rooms_unshare(struct rooms *rooms) {
    struct shared_rooms *all = rooms->shared;
    if (!all)
        return;
    bus_listen(all->bus, NULL, NULL);
    each(all, detach);
    forwards_close(all);
    rooms->shared = NULL;
    rooms->sharing_calls = NULL;
    uv_close((uv_handle_t *)all->tick, free_timer);
    uv_close((uv_handle_t *)all->soon, free_timer);
    free(all);
}
