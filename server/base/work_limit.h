/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When a work of another thread has to stop before it is done: nobody wants its result any more, or it has
 * taken all the processor time that it may. A work asks at each step that is short by itself. */
#ifndef FACCIA_BASE_WORK_LIMIT_H
#define FACCIA_BASE_WORK_LIMIT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct work_limit {
    const atomic_bool *given_up; /* nobody waits for it any more; NULL = never */
    uint64_t until;              /* ns of its thread's processor time; 0 = no such limit */
    unsigned asked;              /* the clock is read every so many times */
    bool late;                   /* it has taken too long */
};

/* From now on, for the calling thread. seconds = 0: it may take as long as it likes. */
struct work_limit work_limit_begin(const atomic_bool *given_up, unsigned seconds);

/* Whether to stop; once true, always true. limit = NULL: never. */
bool work_limit_over(struct work_limit *limit);

#endif
