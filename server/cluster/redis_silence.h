/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long a server has been silent, as far as a loop that looks now and then can tell. */
#ifndef FACCIA_CLUSTER_REDIS_SILENCE_H
#define FACCIA_CLUSTER_REDIS_SILENCE_H

#include <stdint.h>

struct silence {
    uint64_t ms;        /* since the last answer, or the question to which none has come */
    uint64_t looked_at; /* loop time */
};

static inline void silence_begin(struct silence *silence, uint64_t now) {
    *silence = (struct silence){.looked_at = now};
}

/* A loop that was busy, or a process that had no processor, has not looked meanwhile: however long it was
 * away, it counts as most ms, after which it reads what has come before it judges. */
static inline void silence_count(struct silence *silence, uint64_t now, uint64_t most) {
    uint64_t since = now - silence->looked_at;
    silence->ms += since < most ? since : most;
    silence->looked_at = now;
}

#endif
