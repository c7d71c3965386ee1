/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The board in a Redis server. */
#ifndef FACCIA_CLUSTER_REDIS_BOARD_H
#define FACCIA_CLUSTER_REDIS_BOARD_H

#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/board.h"
#include <uv.h>

/* As redis_bus_open. */
struct board *redis_board_open(uv_loop_t *loop, const char *address, struct metrics *metrics,
                               struct error *e);

#endif
