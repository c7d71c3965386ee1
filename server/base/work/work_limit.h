/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells a job in another thread when to stop early: its result is no longer needed, or its processor time
 * is used up. The job checks it at every step, and each step must be short. */
#ifndef FACCIA_BASE_WORK_LIMIT_H
#define FACCIA_BASE_WORK_LIMIT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct work_limit {
    const atomic_bool *given_up; /* set when the result is no longer needed; NULL = never */
    uint64_t until;              /* deadline in ns of the thread's processor time; 0 = none */
    unsigned asked;              /* number of calls; only every 64th reads the clock */
    bool late;                   /* the deadline has passed */
};

/* Starts the limit for the calling thread. seconds = 0: no time limit. */
struct work_limit work_limit_begin(const atomic_bool *given_up, unsigned seconds);

/* True if the job must stop; stays true. limit = NULL: never. */
bool work_limit_over(struct work_limit *limit);

#endif
