/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cluster in a build without hiredis: nothing can be opened, so that only NULL is ever passed to these.
 */
#include "server/cluster/cluster.h"

static void *refuse(struct error *e) {
    error_in_field(e, ERROR_BAD_FIELD, "--cluster",
                   "this daemon was built without hiredis and cannot join a cluster");
    return NULL;
}

struct cluster *cluster_open(uv_loop_t *loop, const struct cluster_options *options, struct error *e) {
    (void)loop, (void)options;
    return refuse(e);
}

bool cluster_up(const struct cluster *cluster) {
    (void)cluster;
    return false;
}

struct cluster_ask *cluster_ask(struct cluster *cluster, const struct buf *key, cluster_answered answered,
                                void *ctx) {
    (void)cluster, (void)key, (void)answered, (void)ctx;
    return NULL;
}

void cluster_forget(struct cluster_ask *ask) {
    (void)ask;
}

void cluster_making(struct cluster *cluster, const struct buf *key) {
    (void)cluster, (void)key;
}

void cluster_give(struct cluster *cluster, const struct buf *key, const struct buf *value) {
    (void)cluster, (void)key, (void)value;
}

void cluster_close(struct cluster *cluster) {
    (void)cluster;
}

struct bus *bus_open(uv_loop_t *loop, const char *address, struct metrics *metrics, struct error *e) {
    (void)loop, (void)address, (void)metrics;
    return refuse(e);
}

const char *bus_name(const struct bus *bus) {
    (void)bus;
    return "";
}

bool bus_up(const struct bus *bus) {
    (void)bus;
    return false;
}

void bus_listen(struct bus *bus, const struct bus_ear *ear, void *ctx) {
    (void)bus, (void)ear, (void)ctx;
}

void bus_claim(struct bus *bus, const char *lease, uint64_t above) {
    (void)bus, (void)lease, (void)above;
}

void bus_leave(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
               const void *data, size_t size) {
    (void)bus, (void)right, (void)to, (void)data, (void)size;
}

void bus_send(struct bus *bus, const struct bus_right *right, const struct bus_receivers *to,
              const void *data, size_t size) {
    (void)bus, (void)right, (void)to, (void)data, (void)size;
}

void bus_close(struct bus *bus) {
    (void)bus;
}

struct presence *presence_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                               struct error *e) {
    (void)loop, (void)address, (void)metrics;
    return refuse(e);
}

void presence_watch(struct presence *presence, const struct presence_callbacks *eye, void *ctx) {
    (void)presence, (void)eye, (void)ctx;
}

void presence_publish(struct presence *presence, const char *name, const char *text) {
    (void)presence, (void)name, (void)text;
}

void presence_mark(struct presence *presence, const char *name, uint64_t until) {
    (void)presence, (void)name, (void)until;
}

void presence_close(struct presence *presence) {
    (void)presence;
}

struct work *work_open(uv_loop_t *loop, const struct work_options *options, struct error *e) {
    (void)loop, (void)options;
    return refuse(e);
}

void work_watch(struct work *work, work_seen seen, void *ctx) {
    (void)work, (void)seen, (void)ctx;
}

struct work_task *work_put(struct work *work, const char *queue, enum work_turn turn, uint32_t quota_key,
                           const struct buf *sentence, work_answered answered, void *ctx) {
    (void)work, (void)queue, (void)turn, (void)quota_key, (void)sentence, (void)answered, (void)ctx;
    return NULL;
}

void work_cancel(struct work_task *task) {
    (void)task;
}

void work_close(struct work *work) {
    (void)work;
}
