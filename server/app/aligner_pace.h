/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the aligner keeps out of everybody's way. */
#ifndef FACCIA_APP_ALIGNER_PACE_H
#define FACCIA_APP_ALIGNER_PACE_H

#include <sys/types.h>

/* Behind all others: what is started later is so, too. It ends with its parent. */
void pace_give_way(unsigned megabytes);

struct pace {
    double percent; /* of one processor */
    double begun;   /* s, monotonic */
};

void pace_begin(struct pace *pace, double percent);

/* Sleeps until the processor time of this process and its helper (0 = none) is no more than their share of
 * the time that has passed. What comes until the next call may take some minutes of the processor; more of it
 * ends the process (SIGXCPU). */
void pace_keep(struct pace *pace, pid_t helper);

#endif
