/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/codec_load.h"

/* The threads are to be busy for this part of the time; above MOST they do less, and they do more only when
 * that would leave them below WELL. */
#define MOST 0.8
#define WELL 0.6
/* Threads that never wait have fallen behind, nobody knows by how much. */
#define SWAMPED 0.97
#define SWAMPED_DEMAND 2.0

/* Costs: libopus 1.3.1 and the resampling from 22050 to 16000 Hz, tests/bench/sound.mjs. */
const struct codec_load_level codec_load_levels[CODEC_LOAD_LEVELS] = {
    {9, false, 19.5}, {5, false, 10.2}, {1, false, 4.7}, {5, true, 4.2}, {0, true, 1.6},
};

void codec_load_open(struct codec_load *codec_load, uv_loop_t *loop, const struct coder_pool *coders,
                     struct metrics *metrics) {
    *codec_load = (struct codec_load){.loop = loop, .coders = coders, .metrics = metrics};
    uv_loop_configure(loop, UV_METRICS_IDLE_TIME);
}

static unsigned less(unsigned level, double busy) {
    double demand = busy > SWAMPED ? SWAMPED_DEMAND : busy, now = codec_load_levels[level].cost;
    if (level + 1 < CODEC_LOAD_LEVELS)
        level++;
    while (level + 1 < CODEC_LOAD_LEVELS && demand * codec_load_levels[level].cost / now > MOST)
        level++;
    return level;
}

unsigned codec_load_choose(unsigned level, double busy, bool calm) {
    if (busy > MOST)
        return less(level, busy);
    if (calm && level && busy * codec_load_levels[level - 1].cost / codec_load_levels[level].cost < WELL)
        return level - 1;
    return level;
}

double codec_load_busy(double loop, double coders, unsigned threads) {
    /* a loop that has much to do beside coding is helped when it shares its processors, but not otherwise */
    bool shares = loop + coders * threads > WELL * threads;
    return loop > MOST && shares && loop > coders ? loop : coders;
}

unsigned codec_load_now(struct codec_load *e) {
    if (!e || !e->coders)
        return CODEC_LOAD_BEST;
    uint64_t now = uv_hrtime(), took = now - e->from;
    if (took < CODEC_LOAD_WINDOW_MS * 1000000ull)
        return e->level;
    uint64_t idle = uv_metrics_idle_time(e->loop), worked = coder_pool_worked(e->coders);
    unsigned threads = coder_pool_threads(e->coders);
    double loop = 1 - (double)(idle - e->idle) / (double)took;
    double busy = codec_load_busy(loop, (double)(worked - e->worked) / (double)took / threads, threads);
    bool calm = now - e->changed >= CODEC_LOAD_CALM_MS * 1000000ull;
    unsigned level = codec_load_choose(e->level, busy, calm);
    if (level != e->level) {
        e->changed = now;
        metrics_add(e->metrics, METRIC_SOUND_LEVEL, (double)level - e->level);
    }
    e->level = level;
    e->from = now;
    e->idle = idle;
    e->worked = worked;
    return level;
}
