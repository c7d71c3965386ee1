/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A process that parses untrusted input (faccia-reader, server/daemon/reader.c). It has limits of processor
 * time and memory, sees only its input, and is killed when its result is no longer needed. Each input gets
 * its own process, so that no input can see another. */
#ifndef FACCIA_BASE_READER_PROCESS_H
#define FACCIA_BASE_READER_PROCESS_H

#include "server/base/error.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

/* How reader processes are started. */
struct reader {
    const char *program; /* path of faccia-reader; NULL or "": parse in this process, without limits */
    bool unconfined;     /* run without the sandbox */
};

/* Limits for one input. */
struct reader_limits {
    unsigned seconds;   /* of processor time; the wall time limit is ten times that */
    unsigned megabytes; /* of address space */
};

struct reader_process {
    pid_t pid; /* 0 = not running */
    int fd;    /* its standard output */
    struct reader_limits limits;
    unsigned patience;           /* wall time limit, s */
    uint64_t until;              /* its deadline, ms of the monotonic clock */
    const atomic_bool *given_up; /* set when the result is no longer needed; may be NULL */
};

/* Starts the reader with a NULL-terminated list of arguments; input: its standard input, -1 = none.
 * Returns -1 with *e ("bad-work"). */
int reader_process_start(struct reader_process *p, const struct reader *reader,
                         const struct reader_limits *limits, const char *const args[], int input,
                         const atomic_bool *given_up, struct error *e);

/* Reads exactly `size` bytes. False: it ended early, timed out or was given up. */
bool reader_process_read(struct reader_process *p, void *data, size_t size);

/* Restarts the wall time limit, for a result that is consumed gradually. */
void reader_process_go_on(struct reader_process *p, unsigned seconds);

/* Ends the process, even if it is still running. 0: it exited successfully. -1: `why` is the reason, such
 * as "took more than 5 s of processor time". */
int reader_process_end(struct reader_process *p, char *why, size_t cap);

/* Returns a descriptor to read the bytes from, or -1. */
int reader_input(const void *data, size_t size);

#endif
