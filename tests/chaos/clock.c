/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A steppable wall clock, to be preloaded. FACCIA_CLOCK_FILE contains 8 bytes: the seconds by which the clock
 * is ahead. It applies only to the command FACCIA_CLOCK_OF, not to its children. CLOCK_MONOTONIC, which
 * measures durations, is unaffected. libfaketime does not work with a Redis that uses jemalloc, which reads
 * the time before any library is initialised. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const volatile int64_t *ahead; /* NULL: the true time */

__attribute__((constructor)) static void clock_begin(void) {
    const char *path = getenv("FACCIA_CLOCK_FILE"), *command = getenv("FACCIA_CLOCK_OF");
    if (!path || !command || strcmp(command, program_invocation_short_name) != 0)
        return;
    int file = open(path, O_RDONLY | O_CLOEXEC);
    void *map = file < 0 ? MAP_FAILED : mmap(NULL, sizeof *ahead, PROT_READ, MAP_SHARED, file, 0);
    if (file >= 0)
        close(file);
    if (map != MAP_FAILED)
        ahead = map;
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    if (syscall(SYS_clock_gettime, clock, now))
        return -1;
    if (ahead && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
        now->tv_sec += *ahead;
    return 0;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone) {
    struct timespec precise;
    (void)zone;
    clock_gettime(CLOCK_REALTIME, &precise);
    *now = (struct timeval){precise.tv_sec, precise.tv_nsec / 1000};
    return 0;
}

time_t time(time_t *out) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME_COARSE, &now);
    if (out)
        *out = now.tv_sec;
    return now.tv_sec;
}
