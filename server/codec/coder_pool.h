/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the quality of Opus coding by load, and codes on threads. The best quality takes twenty times
 * the CPU of everything else in a stream. It is used while there is spare time; with many streams the
 * quality drops so that sound is never late. */
#ifndef FACCIA_CODEC_CODER_POOL_H
#define FACCIA_CODEC_CODER_POOL_H

#include "server/base/metrics.h"
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

enum {
    CODEC_LOAD_BEST = 0, /* levels, the most expensive first */
    CODEC_LOAD_LEVELS = 5,
    CODEC_LOAD_WINDOW_MS = 250,
    CODEC_LOAD_CALM_MS = 2000, /* a level is kept this long before it becomes more expensive */
};

/* Settings of the Opus coder at a level; see opus_encoder_ctl. */
struct codec_load_level {
    int complexity; /* 0..10 */
    bool transform; /* transform coding only (CELT, which needs OPUS_BITRATE_MOST), no voice model (SILK) */
    double cost;    /* ms of CPU per second of speech */
};
extern const struct codec_load_level codec_load_levels[CODEC_LOAD_LEVELS];

struct codec_load {
    uv_loop_t *loop;
    const struct coder_pool *coders;
    uint64_t from, idle, worked; /* of the window, ns */
    uint64_t changed;            /* time of the last change, ns */
    unsigned level;
    struct metrics *metrics;
};

/* Call before the loop runs, because it enables the loop's idle time metric. coders: borrowed; NULL =
 * always best quality. metrics: borrowed; NULL = none. */
void codec_load_open(struct codec_load *codec_load, uv_loop_t *loop, const struct coder_pool *coders,
                     struct metrics *metrics);

/* Returns the current level; NULL = best. */
unsigned codec_load_now(struct codec_load *codec_load);

/* Returns the coders' utilisation, 0..1, from the loop's and the threads' share of time, which includes
 * waiting for a processor. */
double codec_load_busy(double loop, double coders, unsigned threads);

/* Chooses the level after a window of that utilisation. calm: it may become more expensive. */
unsigned codec_load_choose(unsigned level, double busy, bool calm);

/* Threads for coding. Jobs are grouped in lines: those of one line run one at a time and in order,
 * different lines run in parallel. All functions belong to the loop's thread. */

enum { CODER_THREADS_MAX = 8 };

/* Embed as the first member. */
struct coder_job {
    struct coder_job *next;
    void (*work)(struct coder_job *job); /* on a thread; skipped if cancelled in time */
    void (*done)(struct coder_job *job); /* on the loop, in the line's order; owns the job */
    bool urgent;                         /* if it is the first of its line, the line goes first */
    bool cancelled;
};

/* Zero-initialised. Must not move while it has jobs. */
struct coder_line {
    struct coder_line *next;
    struct coder_job *first, *last;
    bool queued; /* assigned to a thread, or in the list of waiting lines */
};

struct coder_pool;

/* threads = 0: one per two processors, leaving the rest for voices and the loop, at most
 * CODER_THREADS_MAX. Returns NULL when no thread can be started. */
struct coder_pool *coder_pool_open(uv_loop_t *loop, unsigned threads);

/* Waits for running jobs and cancels the others; all are done before it returns. The pool is freed once
 * the loop has run. */
void coder_pool_close(struct coder_pool *pool);

void coder_pool_submit(struct coder_pool *pool, struct coder_line *line, struct coder_job *job);

/* Cancels the jobs not yet started that `which` selects; done is still called in order. */
void coder_pool_cancel(struct coder_pool *pool, struct coder_line *line,
                       bool (*which)(struct coder_job *job));

unsigned coder_pool_threads(const struct coder_pool *pool);

/* Total working time of all threads, ns, including waiting for a processor. */
uint64_t coder_pool_worked(const struct coder_pool *pool);

#endif
