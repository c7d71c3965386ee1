/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits how many long jobs of a kind run on libuv's few shared threads. The rest wait here, so that other
 * work finds a free thread. For the loop's thread only. */
#ifndef FACCIA_BASE_WORK_GATE_H
#define FACCIA_BASE_WORK_GATE_H

#include <stdbool.h>
#include <uv.h>

/* Number of concurrent jobs; libuv has 4 threads by default (UV_THREADPOOL_SIZE). */
enum { WORK_GATE_MOST = 2 };

struct gated_work {
    uv_work_t work; /* `data` belongs to the owner */
    uv_work_cb in_thread;
    uv_after_work_cb after;
    struct work_gate *gate;
    struct gated_work *next;
    bool waits;
};

/* Zeroed = idle. */
struct work_gate {
    uv_loop_t *loop;
    unsigned running;
    struct gated_work *first, *last; /* waiting jobs */
};

/* Like uv_queue_work; gate NULL: no limit. `after` may submit the same job again, or free it. */
void work_gate_submit(struct work_gate *gate, uv_loop_t *loop, struct gated_work *work, uv_work_cb in_thread,
                      uv_after_work_cb after);

/* Like uv_cancel: `after` is still called, later. A waiting job still runs in its turn, and must itself
 * check whether it is needed. */
void work_gate_cancel(struct gated_work *work);

#endif
