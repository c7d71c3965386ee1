/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/work/work_limit.h"
#include <stddef.h>
#include <time.h>

/* Calls between clock readings, which are system calls; a step may be as short as a tag. */
enum { ASKED_EACH = 64 };

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
}

struct work_limit work_limit_begin(const atomic_bool *given_up, unsigned seconds) {
    return (struct work_limit){.given_up = given_up,
                               .until = seconds ? now() + (uint64_t)seconds * 1000000000 : 0};
}

bool work_limit_over(struct work_limit *limit) {
    if (!limit)
        return false;
    if (limit->given_up && atomic_load_explicit(limit->given_up, memory_order_relaxed))
        return true;
    if (limit->until && !limit->late && ++limit->asked % ASKED_EACH == 0)
        limit->late = now() > limit->until;
    return limit->late;
}
