/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cluster_place.h"
#ifdef HAVE_REDIS
#include "server/cluster/redis_cluster.h"
#include "server/cluster/redis_work.h"
#endif

int cluster_place_open(const struct settings *settings, uv_loop_t *loop, struct metrics *metrics,
                       struct cluster **out, struct work **work, struct error *e) {
    *out = NULL;
    *work = NULL;
    if (!settings->cluster || !*settings->cluster)
        return 0;
#ifdef HAVE_REDIS
    const struct redis_options options = {settings->cluster, settings->cluster_keep_hours, metrics};
    *out = redis_cluster_open(loop, &options, e);
    const struct redis_work_options queue = {settings->cluster, settings->cluster_queue, metrics};
    if (*out)
        *work = redis_work_open(loop, &queue, e);
    return *work ? 0 : -1;
#else
    (void)loop, (void)metrics;
    return error_in_field(e, ERROR_BAD_FIELD, "--cluster",
                          "this daemon was built without hiredis, and shares nothing");
#endif
}
