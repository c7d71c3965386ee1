/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a daemon does with the bus for one of its rooms. */
#include "server/net/homes_internal.h"
#include <stdio.h>

enum { LEASE_NAME_BYTES = sizeof "room:" + TOKEN_ROOM };

static void name_lease(const struct home *h, char name[LEASE_NAME_BYTES]) {
    snprintf(name, LEASE_NAME_BYTES, "room:%s", h->channel->name);
}

struct home *home_find(const struct homes *homes, const char *room) {
    const struct channel *c = channel_find(homes->net, room);
    return c ? c->home : NULL;
}

uint64_t home_now(const struct homes *homes) {
    return uv_now(homes->net->pipeline->loop);
}

void home_claim(const struct home *h) {
    char name[LEASE_NAME_BYTES];
    name_lease(h, name);
    bus_claim(h->homes->bus, name, h->above);
}

void home_tell(const struct homes *homes, const char *to, json_t *head) {
    struct buf data = {0};
    json_object_set_new(head, "from", json_string(bus_name(homes->bus)));
    packet_write(&data, head, NULL, 0);
    bus_send(homes->bus, NULL, &(struct bus_receivers){&to, 1}, data.data, data.size);
    buf_free(&data);
}

/* FNV-1a of 32 bits, without the highest: JSON has a sign. */
uint64_t home_of(const char *name) {
    uint32_t hash = 2166136261u;
    for (const char *c = name; *c; c++)
        hash = (hash ^ (uint8_t)*c) * 16777619u;
    hash &= INT32_MAX;
    return (uint64_t)(hash ? hash : 1) << 32;
}

uint64_t home_abroad(const struct packet *p) {
    return home_of(p->from) | (uint32_t)packet_number(p, "visit");
}

void home_send(const struct home *h, const struct bus_receivers *to, const struct buf *data) {
    char name[LEASE_NAME_BYTES];
    name_lease(h, name);
    bus_send(h->homes->bus, &(struct bus_right){name, h->token}, to, data->data, data->size);
}

void home_give_up(const struct home *h) {
    home_give_up_as(h, h->token);
}

void home_give_up_as(const struct home *h, uint64_t token) {
    char name[LEASE_NAME_BYTES];
    const char *names[BRANCHES_MOST];
    struct bus_receivers to = {names, 0};
    struct buf data = {0};
    json_t *head = packet_begin("gone", h->channel->name);
    name_lease(h, name);
    for (const struct branch *b = h->branches; b && to.count < BRANCHES_MOST; b = b->next)
        names[to.count++] = b->name;
    json_object_set_new(head, "from", json_string(bus_name(h->homes->bus)));
    packet_write(&data, head, NULL, 0);
    bus_leave(h->homes->bus, &(struct bus_right){name, token}, &to, data.data, data.size);
    buf_free(&data);
}

void home_keep(struct home *h, uint64_t ms) {
    uint64_t until = home_now(h->homes) + ms;
    if (!h->kept_until)
        channel_keep(h->channel);
    h->kept_until = until > h->kept_until ? until : h->kept_until;
}

void home_error(struct error *e) {
    error_plain(e, ERROR_ROOM_AWAY);
}
