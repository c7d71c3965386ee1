/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/worker_process.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Room for a read: the audio of a usual sentence comes in one or two. */
enum { READ_BYTES = 256 << 10 };

/* What a worker that is let go politely may take, ms; more than its own grace. */
enum { POLITE_MS = 2000 };

/* The end of the socket and the exit of the process come together, give or take this many ms. */
enum { END_MS = 100 };

struct local_process {
    struct process process;
    uv_process_t child;
    uv_pipe_t pipe;
    uv_timer_t killer;
    unsigned open;      /* handles that are not closed */
    bool exited, ended; /* the child has; its socket has */
    bool stopped;       /* nobody is to be told any more */
    char how[64];       /* the child exited */
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
    p->callbacks.gone(p->ctx);
    free(p);
}

static void close_handle(uv_handle_t *handle) {
    if (!uv_is_closing(handle))
        uv_close(handle, on_closed);
}

/* The child's handle stays until the child has exited, so that no zombie is left. */
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
        p->callbacks.died(p->ctx, how);
}

/* What the child said before it exited is still to be read; but not for ever, if a child of its own holds the
 * socket. */
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
        p->callbacks.said(p->ctx, &frame);
        at += used;
    }
    buf_consume(&p->in, at);
    if (found < 0 && !p->stopped)
        died(p, "sent garbage");
}

static const struct process_kind local_kind;

struct process *process_start(uv_loop_t *loop, const char *program, const char *plugin,
                              const struct process_callbacks *callbacks, void *ctx, struct error *e) {
    struct local_process *p = mem_alloc(sizeof *p);
    p->process.kind = &local_kind;
    p->callbacks = *callbacks;
    p->ctx = ctx;
    p->child.data = p->pipe.data = p->killer.data = p;
    uv_pipe_init(loop, &p->pipe, 0);
    uv_timer_init(loop, &p->killer);
    p->open = 3;
    char *args[] = {(char *)program, (char *)plugin, (char *)log_format_name(), NULL};
    uv_stdio_container_t stdio[] = {
        {.flags = UV_IGNORE},
        {.flags = UV_INHERIT_FD, .data.fd = 2}, /* what a plugin prints is no part of the daemon's output */
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
    error_set(e, passes ? PROCESS_NO_ROOM : ERROR_VOICE_FAILED, "%s cannot be started: %s", program,
              uv_strerror(result));
    process_stop(&p->process, false);
    return NULL;
}

static void on_sent(uv_write_t *request, int status) {
    (void)status; /* a worker that does not hear is dying: on_exited tells */
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

static const struct process_kind local_kind = {send_local, stop_local};

void process_send(struct process *p, struct buf *b) {
    p->kind->send(p, b);
}

void process_stop(struct process *p, bool politely) {
    p->kind->stop(p, politely);
}
