/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A process that parses what cannot be trusted (faccia-reader, server/app/reader.c): it has limits of
 * processor time and memory, sees nothing but its input, and is killed when its result is no longer wanted.
 * One is started for each input, so that no input sees another. */
#ifndef FACCIA_BASE_READER_PROCESS_H
#define FACCIA_BASE_READER_PROCESS_H

#include "server/base/error.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

/* How inputs are read. */
struct reader {
    const char *program; /* faccia-reader; NULL or "" = in the caller's own process, without limits */
    bool unconfined;     /* without the sandbox */
};

/* What one input may take. */
struct reader_limits {
    unsigned seconds;   /* of processor time; ten times as many by the clock */
    unsigned megabytes; /* of address space */
};

struct reader_process {
    pid_t pid; /* 0 = none runs */
    int fd;    /* what it says */
    struct reader_limits limits;
    unsigned patience;           /* s that it has by the clock, */
    uint64_t until;              /* to there, ms of the monotonic clock */
    const atomic_bool *given_up; /* nobody waits for it any more; NULL = never */
};

/* Starts it with those arguments, which end with a NULL; input: a descriptor that it has as its standard
 * input, or -1 = nothing. -1 with *e ("bad-work"): it cannot be started. */
int reader_process_start(struct reader_process *p, const struct reader *reader,
                         const struct reader_limits *limits, const char *const args[], int input,
                         const atomic_bool *given_up, struct error *e);

/* Reads exactly that many bytes. False: it has ended before, took too long, or nobody waits any more. */
bool reader_process_read(struct reader_process *p, void *data, size_t size);

/* By the clock it has so many seconds from now on: for a result that is taken bit by bit, whenever there is
 * room for more. */
void reader_process_go_on(struct reader_process *p, unsigned seconds);

/* Ends it, also when it still runs. 0: it has ended by itself and well. -1: it has not; why says how, as in
 * "took more than 5 s of processor time". */
int reader_process_end(struct reader_process *p, char *why, size_t cap);

/* Returns a descriptor that reads these bytes from memory, or -1 if none can be made. */
int reader_input(const void *data, size_t size);

#endif
