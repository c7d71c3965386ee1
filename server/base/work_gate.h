/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works of one kind that may take long, on libuv's few threads, which all share: so many of them run at a
 * time, and the others wait here, so that the rest of the threads is free for everything else. For the loop's
 * thread. */
#ifndef FACCIA_BASE_WORK_GATE_H
#define FACCIA_BASE_WORK_GATE_H

#include <stdbool.h>
#include <uv.h>

/* Of libuv's 4 threads (UV_THREADPOOL_SIZE). */
enum { WORK_GATE_MOST = 2 };

struct gated_work {
    uv_work_t work; /* its data are the owner's */
    uv_work_cb in_thread;
    uv_after_work_cb after;
    struct work_gate *gate;
    struct gated_work *next;
    bool waits;
};

/* All zeros = nothing runs. */
struct work_gate {
    uv_loop_t *loop;
    unsigned running;
    struct gated_work *first, *last; /* that wait */
};

/* As uv_queue_work; gate NULL: at once. `after` may submit the same work again, or free it. */
void work_gate_submit(struct work_gate *gate, uv_loop_t *loop, struct gated_work *work, uv_work_cb in_thread,
                      uv_after_work_cb after);

/* As uv_cancel: `after` comes all the same, later. One that waits comes to its turn, and has to see for
 * itself that it is not wanted. */
void work_gate_cancel(struct gated_work *work);

#endif
