/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SIGINT and SIGTERM stop the loop, so that a door ends in good order. */
#ifndef FACCIA_DOORS_ENDING_H
#define FACCIA_DOORS_ENDING_H

#include <uv.h>

struct ending {
    uv_signal_t signals[2];
};

void ending_open(struct ending *ending, uv_loop_t *loop);
/* Then runs the loop until nothing is left in it, and closes it. */
void ending_close(struct ending *ending);

/* Runs the loop until it has nothing to do, for what is freed before the loop is closed. */
void ending_run(struct ending *ending);

#endif
