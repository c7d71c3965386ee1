/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/aligner_pace.h"
#include "server/voice/sandbox.h"
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { LOWEST = 19, STEP_SECONDS = 900 };

static double clock_of(clockid_t id) {
    struct timespec t;
    return clock_gettime(id, &t) ? 0 : (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

void pace_give_way(unsigned megabytes) {
    const struct sched_param none = {0};
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpriority(PRIO_PROCESS, 0, LOWEST);
    sched_setscheduler(0, SCHED_IDLE, &none);
    memory_limit(megabytes);
}

static void limit_step(void) {
    struct rlimit time;
    getrlimit(RLIMIT_CPU, &time);
    time.rlim_cur = (rlim_t)clock_of(CLOCK_PROCESS_CPUTIME_ID) + STEP_SECONDS;
    if (time.rlim_cur > time.rlim_max)
        time.rlim_cur = time.rlim_max;
    setrlimit(RLIMIT_CPU, &time);
}

void pace_begin(struct pace *pace, double percent) {
    *pace = (struct pace){percent, clock_of(CLOCK_MONOTONIC)};
    limit_step();
}

void pace_keep(struct pace *pace, pid_t helper) {
    clockid_t other;
    double used = clock_of(CLOCK_PROCESS_CPUTIME_ID), left;
    if (helper && !clock_getcpuclockid(helper, &other))
        used += clock_of(other);
    double due = pace->begun + used * 100 / pace->percent;
    while ((left = due - clock_of(CLOCK_MONOTONIC)) > 0)
        nanosleep(&(struct timespec){(time_t)left, (long)(1e9 * (left - floor(left)))}, NULL);
    limit_step();
}
