/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon's place among others, as the settings have it. */
#ifndef FACCIA_APP_CLUSTER_PLACE_H
#define FACCIA_APP_CLUSTER_PLACE_H

#include "server/app/settings.h"
#include "server/cluster/board.h"
#include "server/cluster/bus.h"
#include "server/cluster/cluster.h"
#include "server/cluster/work_queue.h"

struct cluster_place {
    struct cluster *cluster; /* what they share; NULL: it is alone */
    struct bus *bus;         /* by which they speak to each other */
    struct board *board;     /* on which they count together */
    struct work *work;       /* what workers elsewhere speak */
};

/* All NULL: it is alone. -1 with *e when the setting is none, or the daemon was built without an engine for
 * it. */
int cluster_place_open(const struct settings *settings, uv_loop_t *loop, struct metrics *metrics,
                       struct cluster_place *out, struct error *e);

/* They are gone when the loop has run out. */
void cluster_place_close(struct cluster_place *place);

#endif
