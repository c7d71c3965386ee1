/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The leader of a shared room: its lease, and this daemon's role, which each answer from the bus may
 * change. */
#include "server/base/log.h"
#include "server/rooms/shared/shared_internal.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEASE_NAME_BYTES = sizeof "room:" + TOKEN_ROOM };

static void name_lease(const struct shared_room *h, char name[LEASE_NAME_BYTES]) {
    snprintf(name, LEASE_NAME_BYTES, "room:%s", h->channel->name);
}

struct shared_room *shared_find(const struct shared_rooms *all, const char *room) {
    const struct channel *c = channel_find(all->rooms, room);
    return c ? c->shared : NULL;
}

uint64_t shared_now(const struct shared_rooms *all) {
    return uv_now(all->rooms->pipeline->loop);
}

void shared_claim(const struct shared_room *h) {
    char name[LEASE_NAME_BYTES];
    name_lease(h, name);
    bus_claim(h->all->bus, name, h->above);
}

void shared_tell(const struct shared_rooms *all, const char *to, json_t *head) {
    struct buf data = {0};
    json_object_set_new(head, "from", json_string(bus_name(all->bus)));
    packet_write(&data, head, NULL, 0);
    bus_send(all->bus, NULL, &(struct bus_receivers){&to, 1}, data.data, data.size);
    buf_free(&data);
}

/* 32-bit FNV-1a without the top bit: JSON integers are signed. */
uint64_t shared_daemon(const char *name) {
    uint32_t hash = 2166136261u;
    for (const char *c = name; *c; c++)
        hash = (hash ^ (uint8_t)*c) * 16777619u;
    hash &= INT32_MAX;
    return (uint64_t)(hash ? hash : 1) << 32;
}

uint64_t shared_origin(const struct packet *p) {
    return shared_daemon(p->from) | (uint32_t)packet_number(p, "visit");
}

void shared_send(const struct shared_room *h, const struct bus_receivers *to, const struct buf *data) {
    char name[LEASE_NAME_BYTES];
    name_lease(h, name);
    bus_send(h->all->bus, &(struct bus_right){name, h->token}, to, data->data, data->size);
}

static void shared_give_up_as(const struct shared_room *h, uint64_t token);

void shared_give_up(const struct shared_room *h) {
    shared_give_up_as(h, h->token);
}

static void shared_give_up_as(const struct shared_room *h, uint64_t token) {
    char name[LEASE_NAME_BYTES];
    const char *names[REPLICAS_MOST];
    struct bus_receivers to = {names, 0};
    struct buf data = {0};
    json_t *head = packet_begin("gone", h->channel->name);
    name_lease(h, name);
    for (const struct replica *b = h->replicas; b && to.count < REPLICAS_MOST; b = b->next)
        names[to.count++] = b->name;
    json_object_set_new(head, "from", json_string(bus_name(h->all->bus)));
    packet_write(&data, head, NULL, 0);
    bus_leave(h->all->bus, &(struct bus_right){name, token}, &to, data.data, data.size);
    buf_free(&data);
}

void shared_keep(struct shared_room *h, uint64_t ms) {
    uint64_t until = shared_now(h->all) + ms;
    if (!h->kept_until)
        channel_keep(h->channel);
    h->kept_until = until > h->kept_until ? until : h->kept_until;
}

void shared_error(struct error *e) {
    error_plain(e, ERROR_ROOM_AWAY);
}

/* Hexadecimal digits of a daemon's name, which is random: about a million distinct offsets. */
enum { APART_DIGITS = 5 };

static void count(const struct shared_room *h, int by) {
    static const int metrics[ROLES] = {[ROLE_SEEKING] = -1,
                                       [ROLE_LEADER] = METRIC_ROOMS_LED,
                                       [ROLE_REPLICA] = METRIC_ROOMS_REPLICATED,
                                       [ROLE_ALONE] = METRIC_ROOMS_UNSHARED};
    if (metrics[h->role] >= 0)
        metrics_add(h->all->rooms->pipeline->metrics, (enum metric)metrics[h->role], by);
}

void shared_set_role(struct shared_room *h, enum shared_role role) {
    count(h, -1);
    h->role = role;
    count(h, 1);
}

/* Ends what another daemon speaks here. again: it will be spoken again; forwards_again: forwarded commands
 * are sent again where so requested. */
static void lose(struct shared_room *h, uint32_t told, bool again, bool forwards_again) {
    struct error e;
    shared_error(&e);
    channel_cut(h->channel, &e, again);
    forwards_lost(h, told, forwards_again, &e);
    shared_is_past(h, told);
}

/* Ends what another daemon spoke here. next: there is a new leader, and each daemon sends its own commands
 * again to it where so requested. */
static void cut(struct shared_room *h, bool next) {
    if (h->role != ROLE_REPLICA)
        return;
    uint32_t told = channel_utterance(h->channel);
    lose(h, told, channel_is_again(h->channel) && (next || forwards_again(h, told)), true);
}

void shared_missed(struct shared_room *h) {
    lose(h, channel_utterance(h->channel), false, false);
    h->recapped = false;
    h->knew = true;
    h->visit = ++h->all->visits;
    h->begin = true;
    shared_report(h);
}

/* Ends the utterance of this daemon. */
static void fail(struct shared_room *h) {
    struct error e;
    shared_error(&e);
    if (stream_busy(h->channel->stream))
        stream_fail(h->channel->stream, &e);
}

/* Daemons that are alone number utterances independently, and a follower may later see the numbers of
 * several: each daemon continues at its own offset. Beyond half of the range the offset is not added; only
 * a room whose Redis is cut off deliberately gets that far. */
static void number_apart(const struct shared_room *h) {
    char digits[APART_DIGITS + 1];
    uint32_t number = stream_number(h->channel->stream);
    snprintf(digits, sizeof digits, "%s", bus_name(h->all->bus));
    if (number < UINT32_MAX / 2)
        stream_number_above(h->channel->stream, number + 1 + (uint32_t)strtoul(digits, NULL, 16));
}

void shared_be_alone(struct shared_room *h) {
    enum shared_role was = h->role;
    cut(h, false);
    replicas_drop(h);
    shared_set_role(h, ROLE_ALONE);
    stream_go_alone(h->channel->stream);
    if (was != ROLE_ALONE)
        number_apart(h);
    h->heal_by = 0;
    h->split = h->above;
    h->channel->speaks_until = UINT64_MAX;
    if (was == ROLE_REPLICA)
        channel_take(h->channel, false);
}

static void be_here(struct shared_room *h, uint64_t token, uint64_t asked) {
    enum shared_role was = h->role;
    cut(h, true);
    /* the replicas know only the old token: for them its utterance has ended */
    if (was == ROLE_LEADER && token != h->token && h->replicas)
        fail(h);
    shared_set_role(h, ROLE_LEADER);
    if (token != h->token || was != ROLE_LEADER)
        log_info("room %s: spoken by this daemon from now on (%" PRIu64 ")", h->channel->name, token);
    h->token = token;
    h->channel->speaks_until = asked + BUS_LEASE_MS - LEASE_MARGIN_MS;
    if (was == ROLE_REPLICA)
        channel_take(h->channel, false);
}

static void be_replica(struct shared_room *h, const char *holder, uint64_t token) {
    cut(h, true);
    replicas_drop(h);
    h->knew = h->role != ROLE_SEEKING;
    shared_set_role(h, ROLE_REPLICA);
    snprintf(h->holder, sizeof h->holder, "%s", holder);
    h->token = token;
    h->recapped = false;
    h->visit = ++h->all->visits;
    h->channel->speaks_until = 0;
    fail(h);
    channel_take(h->channel, true);
    log_info("room %s: spoken by the daemon %.8s (%" PRIu64 ")", h->channel->name, holder, token);
    h->begin = true;
    shared_report(h);
}

static bool comes_to_its_end(const struct shared_room *h) {
    return h->role == ROLE_ALONE && stream_busy(h->channel->stream) && shared_now(h->all) < h->heal_by;
}

void shared_claimed(struct shared_room *h, const char *holder, uint64_t token, uint64_t asked) {
    bool mine = holder && !strcmp(holder, bus_name(h->all->bus));
    if (token > h->above)
        h->above = token;
    if (!holder) {
        if (h->role != ROLE_ALONE)
            shared_be_alone(h);
    } else if (mine && h->role == ROLE_ALONE && token <= h->split) {
        /* commands sent under that token were given up by their senders */
        shared_give_up_as(h, token);
        shared_claim(h);
    } else if (mine) {
        be_here(h, token, asked);
    } else if (h->role == ROLE_REPLICA && token == h->token && !strcmp(holder, h->holder)) {
        return;
    } else if (!comes_to_its_end(h)) {
        be_replica(h, holder, token);
    }
}

void shared_report(struct shared_room *h) {
    const struct channel *c = h->channel;
    json_t *head = packet_begin("here", c->name), *wants = json_array();
    for (const struct variant *v = c->variants; v; v = v->next)
        json_array_append_new(wants, json_pack("[iiib]", v->encoding.audio, v->encoding.fap,
                                               v->encoding.kilobits, v->encoding.packed));
    json_object_set_new(head, "wants", wants);
    json_object_set_new(head, "number", json_integer(stream_number(c->stream)));
    json_object_set_new(head, "followers", json_integer((json_int_t)channel_followers(c)));
    json_object_set_new(head, "listeners", json_integer((json_int_t)channel_listeners(c)));
    json_object_set_new(head, "begin", json_boolean(h->begin));
    json_object_set_new(head, "visit", json_integer(h->visit));
    if (c->idles)
        json_object_set_new(head, "idle",
                            json_pack("{sf sI sf sb}", "life", c->idling.life, "seed",
                                      (json_int_t)c->idling.seed, "fps", c->idling.fps, "still",
                                      c->idling.still));
    shared_tell(h->all, h->holder, head);
    h->begin = h->stale = false;
    h->here = shared_now(h->all);
}
