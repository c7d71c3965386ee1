/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/work/loop_idle.h"
#include "server/base/mem.h"
#include <stdlib.h>

struct loop_idle {
    uv_prepare_t before_poll;
    uv_check_t after_poll;
    void (*call)(void *ctx);
    void *ctx;
    bool waits;
    unsigned handles;
};

static void on_before_poll(uv_prepare_t *handle) {
    struct loop_idle *t = handle->data;
    t->call(t->ctx);
}

static void on_after_poll(uv_check_t *handle) {
    struct loop_idle *t = handle->data;
    t->call(t->ctx);
}

struct loop_idle *loop_idle_open(uv_loop_t *loop, void (*call)(void *ctx), void *ctx) {
    struct loop_idle *t = mem_alloc(sizeof *t);
    *t = (struct loop_idle){.call = call, .ctx = ctx, .handles = 2};
    uv_prepare_init(loop, &t->before_poll);
    uv_check_init(loop, &t->after_poll);
    t->before_poll.data = t->after_poll.data = t;
    return t;
}

void loop_idle_wait(struct loop_idle *t, bool waits) {
    if (t->waits == waits)
        return;
    t->waits = waits;
    if (waits) {
        uv_prepare_start(&t->before_poll, on_before_poll);
        uv_check_start(&t->after_poll, on_after_poll);
    } else {
        uv_prepare_stop(&t->before_poll);
        uv_check_stop(&t->after_poll);
    }
}

bool loop_idle_waits(const struct loop_idle *t) {
    return t->waits;
}

static void on_closed(uv_handle_t *handle) {
    struct loop_idle *t = handle->data;
    if (!--t->handles)
        free(t);
}

void loop_idle_close(struct loop_idle *t) {
    uv_close((uv_handle_t *)&t->before_poll, on_closed);
    uv_close((uv_handle_t *)&t->after_poll, on_closed);
}
