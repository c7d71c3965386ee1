/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon's place among others, as the settings have it. */
#ifndef FACCIA_APP_CLUSTER_PLACE_H
#define FACCIA_APP_CLUSTER_PLACE_H

#include "server/app/settings.h"
#include "server/cluster/cluster.h"
#include "server/cluster/work_queue.h"

/* Both NULL: it is alone. -1 with *e when the setting is none, or the daemon was built without an engine for
 * it. */
int cluster_place_open(const struct settings *settings, uv_loop_t *loop, struct metrics *metrics,
                       struct cluster **out, struct work **work, struct error *e);

#endif
