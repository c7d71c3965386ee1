/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Public functions of the cluster: they call the engine's table. */
#include "server/cluster/cluster.h"
#include "server/cluster/bus.h"
#include "server/cluster/presence.h"
#include "server/cluster/work_queue.h"
#include <stddef.h>

bool cluster_up(const struct cluster *cluster) {
    return cluster && cluster->engine->up(cluster);
}

struct cluster_ask *cluster_ask(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                                void *ctx) {
    return cluster->engine->ask(cluster, key, answered, ctx);
}

void cluster_forget(struct cluster_ask *ask) {
    if (ask)
        ask->cluster->engine->forget(ask);
}

void cluster_making(struct cluster *cluster, const struct buf *key) {
    cluster->engine->making(cluster, key);
}

void cluster_give(struct cluster *cluster, const struct buf *key, const struct buf *value) {
    cluster->engine->give(cluster, key, value);
}

void cluster_close(struct cluster *cluster) {
    if (cluster)
        cluster->engine->close(cluster);
}

void presence_watch(struct presence *presence, const struct presence_callbacks *eye, void *ctx) {
    presence->engine->look(presence, eye, ctx);
}

void presence_publish(struct presence *presence, const char *name, const char *text) {
    presence->engine->write(presence, name, text);
}

void presence_mark(struct presence *presence, const char *name, uint64_t until) {
    presence->engine->mark(presence, name, until);
}

void presence_close(struct presence *presence) {
    if (presence)
        presence->engine->close(presence);
}

const char *bus_name(const struct bus *bus) {
    return bus->engine->name(bus);
}

bool bus_up(const struct bus *bus) {
    return bus->engine->up(bus);
}

void bus_listen(struct bus *bus, const struct bus_ear *ear, void *ctx) {
    bus->engine->listen(bus, ear, ctx);
}

void bus_claim(struct bus *bus, const char *lease, uint64_t above) {
    bus->engine->claim(bus, lease, above);
}

void bus_leave(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
               const void *data, size_t size) {
    bus->engine->leave(bus, right, to, data, size);
}

void bus_send(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
              const void *data, size_t size) {
    bus->engine->send(bus, right, to, data, size);
}

void bus_close(struct bus *bus) {
    if (bus)
        bus->engine->close(bus);
}

void work_watch(struct work *work, work_seen seen, void *ctx) {
    work->engine->watch(work, seen, ctx);
}

struct work_task *work_put(struct work *work, const char *queue, enum work_turn turn, uint32_t quota_key,
                           const struct buf *sentence, work_answered answered, void *ctx) {
    return work->engine->put(work, queue, turn, quota_key, sentence, answered, ctx);
}

void work_cancel(struct work_task *task) {
    if (task)
        task->work->engine->cancel(task);
}

void work_close(struct work *work) {
    if (work)
        work->engine->close(work);
}

void work_consumer_look(struct work_consumer *consumer) {
    consumer->engine->look(consumer);
}

void work_answer(struct work_item *item, enum work_end end, const struct buf *body) {
    item->consumer->engine->answer(item, end, body);
}

void work_give_back(struct work_item *item) {
    item->consumer->engine->give_back(item);
}

void work_consumer_close(struct work_consumer *consumer) {
    if (consumer)
        consumer->engine->close(consumer);
}
