/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cluster_place.h"
#ifdef HAVE_REDIS
#include "server/cluster/redis_board.h"
#include "server/cluster/redis_bus.h"
#include "server/cluster/redis_cluster.h"
#include "server/cluster/redis_work.h"
#endif

int cluster_place_open(const struct settings *settings, uv_loop_t *loop, struct metrics *metrics,
                       struct cluster_place *out, struct error *e) {
    *out = (struct cluster_place){0};
    if (!settings->cluster || !*settings->cluster)
        return 0;
#ifdef HAVE_REDIS
    const struct redis_options options = {settings->cluster, settings->cluster_keep_hours, metrics};
    const struct redis_work_options queue = {settings->cluster, settings->cluster_queue, metrics};
    if (!(out->cluster = redis_cluster_open(loop, &options, e)) ||
        !(out->bus = redis_bus_open(loop, settings->cluster, metrics, e)) ||
        !(out->board = redis_board_open(loop, settings->cluster, metrics, e)) ||
        !(out->work = redis_work_open(loop, &queue, e)))
        return -1;
    return 0;
#else
    (void)loop, (void)metrics;
    return error_in_field(e, ERROR_BAD_FIELD, "--cluster",
                          "this daemon was built without hiredis, and shares nothing");
#endif
}

void cluster_place_close(struct cluster_place *place) {
    cluster_close(place->cluster);
    bus_close(place->bus);
    board_close(place->board);
    work_close(place->work);
    *place = (struct cluster_place){0};
}
