/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/work/work_gate.h"
#include <stddef.h>

static void in_thread(uv_work_t *work) {
    ((struct gated_work *)work)->in_thread(work);
}

static void begin(struct work_gate *gate, struct gated_work *w);

static void after(uv_work_t *work, int status) {
    struct gated_work *w = (struct gated_work *)work;
    struct work_gate *gate = w->gate;
    struct gated_work *next = gate ? gate->first : NULL;
    if (gate)
        gate->running--;
    if (next) {
        gate->first = next->next;
        gate->last = gate->first ? gate->last : NULL;
        begin(gate, next);
    }
    w->after(work, status);
}

static void begin(struct work_gate *gate, struct gated_work *w) {
    w->waits = false;
    gate->running++;
    uv_queue_work(gate->loop, &w->work, in_thread, after);
}

void work_gate_submit(struct work_gate *gate, uv_loop_t *loop, struct gated_work *w, uv_work_cb work,
                      uv_after_work_cb then) {
    w->in_thread = work;
    w->after = then;
    w->gate = gate;
    w->next = NULL;
    if (!gate) {
        w->waits = false;
        uv_queue_work(loop, &w->work, in_thread, after);
        return;
    }
    gate->loop = loop;
    if (gate->running < WORK_GATE_MOST) {
        begin(gate, w);
        return;
    }
    w->waits = true;
    if (gate->last)
        gate->last->next = w;
    else
        gate->first = w;
    gate->last = w;
}

void work_gate_cancel(struct gated_work *w) {
    if (!w->waits)
        uv_cancel((uv_req_t *)&w->work);
}
