/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much work each stream's sound is given: the better an Opus coder is to sound, the more it computes, and
 * at its best it takes twenty times what all the rest of a stream takes. While the loop has time to spare the
 * sound is as good as can be; when many speak at once it becomes plainer, rather than late. */
#ifndef FACCIA_STREAM_EFFORT_H
#define FACCIA_STREAM_EFFORT_H

#include "server/base/metrics.h"
#include <stdbool.h>
#include <uv.h>

enum {
    EFFORT_BEST = 0, /* levels, the dearest first */
    EFFORT_LEVELS = 5,
    EFFORT_WINDOW_MS = 250,
    EFFORT_CALM_MS = 2000, /* the level stays for so long before it becomes dearer */
};

/* What an Opus coder does at a level; see opus_encoder_ctl. */
struct effort_level {
    int complexity; /* 0..10 */
    bool transform; /* codes by transform alone (CELT, which needs OPUS_BITRATE_MOST), not by a model of the
                       voice (SILK) */
    double cost;    /* ms of CPU for a second of speech, with all else that a stream takes */
};
extern const struct effort_level effort_levels[EFFORT_LEVELS];

struct effort {
    uv_loop_t *loop;
    uint64_t from, idle; /* of the window, ns */
    uint64_t changed;    /* when the level was, ns */
    unsigned level;
    struct metrics *metrics;
};

/* Before the loop runs: it has to count the time in which it waits. metrics: borrowed; NULL = nobody counts.
 */
void effort_open(struct effort *effort, uv_loop_t *loop, struct metrics *metrics);

/* The level of the sound that is coded now. effort = NULL: the best. */
unsigned effort_now(struct effort *effort);

/* The level after a window in which the loop at that level was busy for that part of the time, 0..1. calm: it
 * may become dearer. */
unsigned effort_choose(unsigned level, double busy, bool calm);

#endif
