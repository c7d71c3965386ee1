/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_loop.h"
#include "server/base/mem.h"
#include <stdbool.h>
#include <stdlib.h>

struct redis_loop {
    uv_poll_t poll;
    uv_prepare_t before_poll;
    uv_check_t after_poll;
    redisAsyncContext *context; /* NULL: it is being freed */
    int polled;
    bool writes; /* something waits for the end of the turn */
    unsigned handles;
};

static void on_poll(uv_poll_t *poll, int status, int events) {
    struct redis_loop *l = poll->data;
    if (status < 0) { /* libuv has stopped polling; hiredis sees for itself what is wrong */
        events = l->polled;
        l->polled = 0;
    }
    if (l->context && events & UV_READABLE)
        redisAsyncHandleRead(l->context);
    if (l->context && events & UV_WRITABLE)
        redisAsyncHandleWrite(l->context);
}

static void poll_for(struct redis_loop *l, int events) {
    if (l->polled == events)
        return;
    l->polled = events;
    if (events)
        uv_poll_start(&l->poll, events, on_poll);
    else
        uv_poll_stop(&l->poll);
}

static void wait_for_turn(struct redis_loop *l, bool waits);

/* What the system does not take now leaves when it can. */
static void write_now(struct redis_loop *l) {
    redisAsyncHandleWrite(l->context);
    if (!l->context || !l->writes)
        return;
    wait_for_turn(l, false);
    poll_for(l, l->polled | UV_WRITABLE);
}

static void on_before_poll(uv_prepare_t *prepare) {
    write_now(prepare->data);
}

static void on_after_poll(uv_check_t *check) {
    write_now(check->data);
}

static void wait_for_turn(struct redis_loop *l, bool waits) {
    if (l->writes == waits)
        return;
    l->writes = waits;
    if (waits) {
        uv_prepare_start(&l->before_poll, on_before_poll);
        uv_check_start(&l->after_poll, on_after_poll);
    } else {
        uv_prepare_stop(&l->before_poll);
        uv_check_stop(&l->after_poll);
    }
}

static void add_read(void *data) {
    struct redis_loop *l = data;
    poll_for(l, l->polled | UV_READABLE);
}

static void del_read(void *data) {
    struct redis_loop *l = data;
    poll_for(l, l->polled & ~UV_READABLE);
}

static void add_write(void *data) {
    struct redis_loop *l = data;
    if (!(l->context->c.flags & REDIS_CONNECTED)) /* that it is, the system tells */
        poll_for(l, l->polled | UV_WRITABLE);
    else if (!(l->polled & UV_WRITABLE))
        wait_for_turn(l, true);
}

static void del_write(void *data) {
    struct redis_loop *l = data;
    wait_for_turn(l, false);
    poll_for(l, l->polled & ~UV_WRITABLE);
}

static void on_closed(uv_handle_t *handle) {
    struct redis_loop *l = handle->data;
    if (!--l->handles)
        free(l);
}

static void clean_up(void *data) {
    struct redis_loop *l = data;
    l->context = NULL;
    uv_close((uv_handle_t *)&l->poll, on_closed);
    uv_close((uv_handle_t *)&l->before_poll, on_closed);
    uv_close((uv_handle_t *)&l->after_poll, on_closed);
}

int redis_loop_attach(redisAsyncContext *context, uv_loop_t *loop) {
    struct redis_loop *l = mem_alloc(sizeof *l);
    *l = (struct redis_loop){.context = context, .handles = 3};
    int failed = uv_poll_init(loop, &l->poll, context->c.fd);
    if (failed) {
        free(l);
        return failed;
    }
    uv_prepare_init(loop, &l->before_poll);
    uv_check_init(loop, &l->after_poll);
    l->poll.data = l->before_poll.data = l->after_poll.data = l;
    context->ev.data = l;
    context->ev.addRead = add_read;
    context->ev.delRead = del_read;
    context->ev.addWrite = add_write;
    context->ev.delWrite = del_write;
    context->ev.cleanup = clean_up;
    return 0;
}
