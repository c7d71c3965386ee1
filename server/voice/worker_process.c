/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void reserve_fill(struct reserve *reserve) {
    for (int i = 0; i < RESERVE; i++)
        if (!reserve->fds[i])
            reserve->fds[i] = open("/dev/null", O_RDONLY | O_CLOEXEC) + 1;
}

void reserve_release(struct reserve *reserve) {
    for (int i = 0; i < RESERVE; i++) {
        if (reserve->fds[i])
            close(reserve->fds[i] - 1);
        reserve->fds[i] = 0;
    }
}

/* Read size: a usual sentence's audio takes one or two reads. */
enum { READ_BYTES = 256 << 10 };

/* Grace period of a polite stop, in ms; longer than the worker's own. */
enum { POLITE_MS = 2000 };

/* The socket's end and the process's exit arrive within this time of each other, in ms. */
enum { END_MS = 100 };

struct local_process {
    struct process process;
    uv_process_t child;
    uv_pipe_t pipe;
    uv_timer_t killer;
    unsigned open;      /* handles not yet closed */
    bool exited, ended; /* the child exited; its socket closed */
    bool stopped;       /* no further callbacks but on_closed */
    char how[64];       /* how the child exited */
    struct buf in;
    struct process_callbacks callbacks;
    void *ctx;
};

struct sending {
    uv_write_t request;
    struct buf bytes;
};

static void on_closed(uv_handle_t *handle) {
    struct local_process *p = handle->data;
    if (--p->open)
        return;
    buf_free(&p->in);
    p->callbacks.on_closed(p->ctx);
    free(p);
}

static void close_handle(uv_handle_t *handle) {
    if (!uv_is_closing(handle))
        uv_close(handle, on_closed);
}

/* Keeps the child's handle until it exits, so that no zombie is left. */
static void close_all(struct local_process *p) {
    close_handle((uv_handle_t *)&p->pipe);
    if (p->exited) {
        close_handle((uv_handle_t *)&p->killer);
        close_handle((uv_handle_t *)&p->child);
    }
}

static void died(struct local_process *p, const char *how) {
    bool tell = !p->stopped;
    p->stopped = true;
    if (!p->exited)
        uv_process_kill(&p->child, SIGKILL);
    close_all(p);
    if (tell)
        p->callbacks.on_died(p->ctx, how);
}

/* Waits for remaining output of an exited child, but not forever: one of its children may hold the socket. */
static void on_time(uv_timer_t *timer) {
    struct local_process *p = timer->data;
    if (!p->exited)
        uv_process_kill(&p->child, SIGKILL);
    else
        died(p, p->how);
}

static void check_end(struct local_process *p) {
    if (p->exited && (p->ended || p->stopped))
        died(p, p->how);
    else
        uv_timer_start(&p->killer, on_time, END_MS, 0);
}

static void on_exited(uv_process_t *child, int64_t status, int signal) {
    struct local_process *p = child->data;
    if (signal == SIGXCPU)
        snprintf(p->how, sizeof p->how, "took too much processor time");
    else if (signal)
        snprintf(p->how, sizeof p->how, "was killed by signal %d", signal);
    else
        snprintf(p->how, sizeof p->how, "exited with status %d", (int)status);
    p->exited = true;
    check_end(p);
}

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *room) {
    (void)suggested;
    struct local_process *p = handle->data;
    *room = uv_buf_init(buf_reserve(&p->in, READ_BYTES), READ_BYTES);
}

static void on_read(uv_stream_t *stream, ssize_t n, const uv_buf_t *room) {
    (void)room;
    struct local_process *p = stream->data;
    if (n < 0) {
        uv_read_stop(stream);
        p->ended = true;
        check_end(p);
        return;
    }
    p->in.size += (size_t)n;
    size_t at = 0, used = 0;
    struct wire_frame frame;
    int found = 0;
    while (!p->stopped && (found = wire_next(p->in.data + at, p->in.size - at, &frame, &used)) == 1) {
        p->callbacks.on_frame(p->ctx, &frame);
        at += used;
    }
    buf_consume(&p->in, at);
    if (found < 0 && !p->stopped)
        died(p, "sent garbage");
}

static const struct process_ops local_ops;

struct process *process_start(uv_loop_t *loop, const char *program, const char *plugin,
                              const struct process_callbacks *callbacks, void *ctx, struct error *e) {
    struct local_process *p = mem_alloc(sizeof *p);
    p->process.ops = &local_ops;
    p->callbacks = *callbacks;
    p->ctx = ctx;
    p->child.data = p->pipe.data = p->killer.data = p;
    uv_pipe_init(loop, &p->pipe, 0);
    uv_timer_init(loop, &p->killer);
    p->open = 3;
    char *args[] = {(char *)program, (char *)plugin, (char *)log_format_name(), NULL};
    uv_stdio_container_t stdio[] = {
        {.flags = UV_IGNORE},
        {.flags = UV_INHERIT_FD, .data.fd = 2}, /* plugin output must not mix with the daemon's */
        {.flags = UV_INHERIT_FD, .data.fd = 2},
        [WIRE_FD] = {.flags = UV_CREATE_PIPE | UV_READABLE_PIPE | UV_WRITABLE_PIPE,
                     .data.stream = (uv_stream_t *)&p->pipe},
    };
    const uv_process_options_t options = {
        .exit_cb = on_exited, .file = program, .args = args, .stdio = stdio, .stdio_count = WIRE_FD + 1};
    int result = uv_spawn(loop, &p->child, &options);
    p->exited = result < 0;
    if (result == 0)
        result = uv_read_start((uv_stream_t *)&p->pipe, on_room, on_read);
    if (result == 0)
        return &p->process;
    bool passes = result == UV_EMFILE || result == UV_ENFILE || result == UV_ENOMEM || result == UV_EAGAIN;
    error_set(e, passes ? PROCESS_RETRY : ERROR_VOICE_FAILED, "%s cannot be started: %s", program,
              uv_strerror(result));
    process_stop(&p->process, false);
    return NULL;
}

static void on_sent(uv_write_t *request, int status) {
    (void)status; /* on_exited reports a dying worker */
    struct sending *s = request->data;
    buf_free(&s->bytes);
    free(s);
}

static void send_local(struct process *process, struct buf *b) {
    struct local_process *p = (struct local_process *)process;
    uv_buf_t all = uv_buf_init((char *)b->data, (unsigned)b->size);
    int sent = uv_try_write((uv_stream_t *)&p->pipe, &all, 1);
    if (sent == (int)b->size) {
        b->size = 0;
        return;
    }
    struct sending *s = mem_alloc(sizeof *s);
    if (sent > 0)
        buf_consume(b, (size_t)sent);
    s->bytes = *b;
    s->request.data = s;
    *b = (struct buf){0};
    all = uv_buf_init((char *)s->bytes.data, (unsigned)s->bytes.size);
    if (uv_write(&s->request, (uv_stream_t *)&p->pipe, &all, 1, on_sent) < 0)
        on_sent(&s->request, 0);
}

static void stop_local(struct process *process, bool politely) {
    struct local_process *p = (struct local_process *)process;
    p->stopped = true;
    if (!p->exited && politely)
        uv_timer_start(&p->killer, on_time, POLITE_MS, 0);
    else if (!p->exited)
        uv_process_kill(&p->child, SIGKILL);
    close_all(p);
}

static const struct process_ops local_ops = {send_local, stop_local};

void process_send(struct process *p, struct buf *b) {
    p->ops->send(p, b);
}

void process_stop(struct process *p, bool politely) {
    p->ops->stop(p, politely);
}
