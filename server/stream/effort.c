/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/effort.h"

/* The loop is to be busy for this part of the time; above MOST it does less, and it does more only when that
 * would leave it below WELL. */
#define MOST 0.8
#define WELL 0.6
/* A loop that never waits has fallen behind, nobody knows by how much. */
#define SWAMPED 0.97
#define SWAMPED_DEMAND 2.0

/* Costs: libopus 1.3.1, 24 kHz, tests/bench/speakers.mjs. */
const struct effort_level effort_levels[EFFORT_LEVELS] = {
    {9, false, 15.2}, {5, false, 8.5}, {1, false, 5}, {5, true, 3.2}, {0, true, 1.7},
};

void effort_open(struct effort *effort, uv_loop_t *loop, struct metrics *metrics) {
    *effort = (struct effort){.loop = loop, .metrics = metrics};
    uv_loop_configure(loop, UV_METRICS_IDLE_TIME);
}

static unsigned less(unsigned level, double busy) {
    double demand = busy > SWAMPED ? SWAMPED_DEMAND : busy, now = effort_levels[level].cost;
    if (level + 1 < EFFORT_LEVELS)
        level++;
    while (level + 1 < EFFORT_LEVELS && demand * effort_levels[level].cost / now > MOST)
        level++;
    return level;
}

unsigned effort_choose(unsigned level, double busy, bool calm) {
    if (busy > MOST)
        return less(level, busy);
    if (calm && level && busy * effort_levels[level - 1].cost / effort_levels[level].cost < WELL)
        return level - 1;
    return level;
}

unsigned effort_now(struct effort *e) {
    if (!e)
        return EFFORT_BEST;
    uint64_t now = uv_hrtime(), took = now - e->from;
    if (took < EFFORT_WINDOW_MS * 1000000ull)
        return e->level;
    uint64_t idle = uv_metrics_idle_time(e->loop);
    bool calm = now - e->changed >= EFFORT_CALM_MS * 1000000ull;
    unsigned level = effort_choose(e->level, 1 - (double)(idle - e->idle) / (double)took, calm);
    if (level != e->level) {
        e->changed = now;
        metrics_add(e->metrics, METRIC_SOUND_LEVEL, (double)level - e->level);
    }
    e->level = level;
    e->from = now;
    e->idle = idle;
    return level;
}
