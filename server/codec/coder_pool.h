/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that code, so that the loop is free meanwhile. Jobs stand in lines: those of one line are done one
 * at a time and in their order, those of different lines beside each other. All functions belong to the
 * loop's thread. */
#ifndef FACCIA_CODEC_CODER_POOL_H
#define FACCIA_CODEC_CODER_POOL_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

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

/* threads = 0: as many as there are processors, at most CODER_THREADS_MAX. NULL when none can be had. */
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
