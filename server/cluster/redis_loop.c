/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_loop.h"
#include "server/base/mem.h"
#include "server/base/turn_end.h"
#include <stdlib.h>

struct redis_loop {
    uv_poll_t poll;
    struct turn_end *end;       /* waits while something is to be written then */
    redisAsyncContext *context; /* NULL: it is being freed */
    int polled;
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

/* What the system does not take now leaves when it can. */
static void write_now(void *data) {
    struct redis_loop *l = data;
    redisAsyncHandleWrite(l->context);
    if (!l->context || !turn_end_waits(l->end))
        return;
    turn_end_wait(l->end, false);
    poll_for(l, l->polled | UV_WRITABLE);
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
        turn_end_wait(l->end, true);
}

static void del_write(void *data) {
    struct redis_loop *l = data;
    turn_end_wait(l->end, false);
    poll_for(l, l->polled & ~UV_WRITABLE);
}

static void on_closed(uv_handle_t *poll) {
    free(poll->data);
}

static void clean_up(void *data) {
    struct redis_loop *l = data;
    l->context = NULL;
    turn_end_close(l->end);
    uv_close((uv_handle_t *)&l->poll, on_closed);
}

int redis_loop_attach(redisAsyncContext *context, uv_loop_t *loop) {
    struct redis_loop *l = mem_alloc(sizeof *l);
    *l = (struct redis_loop){.context = context};
    int failed = uv_poll_init(loop, &l->poll, context->c.fd);
    if (failed) {
        free(l);
        return failed;
    }
    l->poll.data = l;
    l->end = turn_end_open(loop, write_now, l);
    context->ev.data = l;
    context->ev.addRead = add_read;
    context->ev.delRead = del_read;
    context->ev.addWrite = add_write;
    context->ev.delWrite = del_write;
    context->ev.cleanup = clean_up;
    return 0;
}
