/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much work each stream's sound is given: the better an Opus coder is to sound, the more it computes, and
 * at its best it takes twenty times what all the rest of a stream takes. While the threads that code have
 * time to spare the sound is as good as can be; when many speak at once it becomes plainer, rather than late.
 */
#ifndef FACCIA_CODEC_CODER_POOL_H
#define FACCIA_CODEC_CODER_POOL_H

#include "server/base/metrics.h"
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

enum {
    CODEC_LOAD_BEST = 0, /* levels, the dearest first */
    CODEC_LOAD_LEVELS = 5,
    CODEC_LOAD_WINDOW_MS = 250,
    CODEC_LOAD_CALM_MS = 2000, /* the level stays for so long before it becomes dearer */
};

/* What an Opus coder does at a level; see opus_encoder_ctl. */
struct codec_load_level {
    int complexity; /* 0..10 */
    bool transform; /* codes by transform alone (CELT, which needs OPUS_BITRATE_MOST), not by a model of the
                       voice (SILK) */
    double cost;    /* ms of CPU for a second of speech */
};
extern const struct codec_load_level codec_load_levels[CODEC_LOAD_LEVELS];

struct codec_load {
    uv_loop_t *loop;
    const struct coder_pool *coders;
    uint64_t from, idle, worked; /* of the window, ns */
    uint64_t changed;            /* when the level was, ns */
    unsigned level;
    struct metrics *metrics;
};

/* Before the loop runs: it has to count the time in which it waits. coders: borrowed; NULL = sound is always
 * at its best. metrics: borrowed; NULL = nobody counts. */
void codec_load_open(struct codec_load *codec_load, uv_loop_t *loop, const struct coder_pool *coders,
                     struct metrics *metrics);

/* The level of the sound that is coded now. codec_load = NULL: the best. */
unsigned codec_load_now(struct codec_load *codec_load);

/* How busy those that code were, 0..1, when the loop and each of so many threads were for such parts of the
 * time, waiting for a processor included. */
double codec_load_busy(double loop, double coders, unsigned threads);

/* The level after a window in which they were so busy at that level. calm: it may become dearer. */
unsigned codec_load_choose(unsigned level, double busy, bool calm);

/* Threads that code, so that the loop is free meanwhile. Jobs stand in lines: those of one line are done one
 * at a time and in their order, those of different lines beside each other. All functions belong to the
 * loop's thread. */

enum { CODER_THREADS_MAX = 8 };

/* To be embedded, first. */
struct coder_job {
    struct coder_job *next;
    void (*work)(struct coder_job *job); /* in one of the threads; not of one that was cancelled in time */
    void (*done)(struct coder_job *job); /* on the loop, in the line's order; owns the job */
    bool urgent;                         /* its line comes before others, if the job is the first in it */
    bool cancelled;
};

/* Zeroed at first. It stays where it is while jobs of it are not done. */
struct coder_line {
    struct coder_line *next;
    struct coder_job *first, *last;
    bool queued; /* a thread has it, or will */
};

struct coder_pool;

/* threads = 0: one for every two processors, so that the voices and the loop have the others, at most
 * CODER_THREADS_MAX. NULL when none can be had. */
struct coder_pool *coder_pool_open(uv_loop_t *loop, unsigned threads);

/* Waits for the jobs that are in work; the others are cancelled. All are done before it returns. The pool is
 * gone when the loop has run on. */
void coder_pool_close(struct coder_pool *pool);

void coder_pool_submit(struct coder_pool *pool, struct coder_line *line, struct coder_job *job);

/* Of those that no thread has begun, the ones of which `which` says so are not worked on; they are done in
 * their turn. */
void coder_pool_cancel(struct coder_pool *pool, struct coder_line *line,
                       bool (*which)(struct coder_job *job));

unsigned coder_pool_threads(const struct coder_pool *pool);

/* For how long all threads together have been at work, ns, waiting for a processor included. */
uint64_t coder_pool_worked(const struct coder_pool *pool);

#endif
