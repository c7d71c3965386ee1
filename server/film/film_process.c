/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_process.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DESCRIPTORS = 5, SAID_BYTES = 400 };

struct film_process {
    uv_process_t child;
    uv_pipe_t input, errors;
    unsigned open; /* handles */
    bool running, exited, errors_ended, well, closed;
    char said[SAID_BYTES + 1]; /* the last bytes of its errors */
    size_t said_size;
    char room[4096];
    void (*ended)(void *ctx, bool well);
    void *ctx;
};

struct writing {
    uv_write_t request;
    void (*done)(void *ctx, int status);
    void *ctx;
};

bool film_process_found(const char *name) {
    const char *path = getenv("PATH");
    char file[4096];
    for (size_t length; path && *path; path += length + (path[length] == ':')) {
        length = strcspn(path, ":");
        snprintf(file, sizeof file, "%.*s/%s", (int)length, path, name);
        if (length && !access(file, X_OK))
            return true;
    }
    return false;
}

static void check_end(struct film_process *p) {
    if (p->exited && p->errors_ended && !p->closed)
        p->ended(p->ctx, p->well);
}

static void on_exit_of(uv_process_t *child, int64_t status, int signal) {
    struct film_process *p = child->data;
    p->running = false;
    p->exited = true;
    p->well = !status && !signal;
    check_end(p);
}

static void on_room(uv_handle_t *handle, size_t size, uv_buf_t *room) {
    struct film_process *p = handle->data;
    (void)size;
    *room = uv_buf_init(p->room, sizeof p->room);
}

/* Keeps the last bytes, on one line. */
static void keep(struct film_process *p, const char *bytes, size_t size) {
    for (size_t i = 0; i < size; i++) {
        char c = bytes[i] == '\n' || bytes[i] == '\t' ? ' ' : bytes[i];
        bool twice = c == ' ' && (!p->said_size || p->said[p->said_size - 1] == ' ');
        if (twice || (unsigned char)c < ' ')
            continue;
        if (p->said_size == SAID_BYTES)
            memmove(p->said, p->said + 1, --p->said_size);
        p->said[p->said_size++] = c;
    }
    p->said[p->said_size] = '\0';
}

static void on_errors(uv_stream_t *stream, ssize_t n, const uv_buf_t *room) {
    struct film_process *p = stream->data;
    if (n >= 0) {
        keep(p, room->base, (size_t)n);
        return;
    }
    uv_read_stop(stream);
    p->errors_ended = true;
    check_end(p);
}

static void on_closed(uv_handle_t *handle) {
    struct film_process *p = handle->data;
    if (!--p->open)
        free(p);
}

/* What the program inherits of our environment, with `home` as HOME and further variables, of which the
 * first with a name counts. Free the list. */
static char **environment(const char *home, const char *const *further) {
    extern char **environ;
    size_t count = 0, used = 0;
    while (environ[count])
        count++;
    for (const char *const *one = further; one && *one; one++)
        count++;
    char **list = mem_alloc((count + 2) * sizeof *list);
    list[used++] = (char *)home;
    for (const char *const *one = further; one && *one; one++)
        list[used++] = (char *)*one;
    for (char **one = environ; *one; one++)
        if (strncmp(*one, "HOME=", 5) != 0)
            list[used++] = *one;
    return list;
}

struct film_process *film_process_start(uv_loop_t *loop, const struct film_process_options *o,
                                        struct error *e) {
    struct film_process *p = mem_alloc(sizeof *p);
    p->ended = o->ended;
    p->ctx = o->ctx;
    p->child.data = p->input.data = p->errors.data = p;
    uv_pipe_init(loop, &p->input, 0);
    uv_pipe_init(loop, &p->errors, 0);
    p->open = 3;
    uv_stdio_container_t stdio[DESCRIPTORS] = {{.flags = UV_IGNORE}};
    stdio[2].flags = UV_CREATE_PIPE | UV_WRITABLE_PIPE;
    stdio[2].data.stream = (uv_stream_t *)&p->errors;
    stdio[o->input].flags = UV_CREATE_PIPE | UV_READABLE_PIPE;
    stdio[o->input].data.stream = (uv_stream_t *)&p->input;
    if (o->given >= 0) {
        stdio[o->as].flags = UV_INHERIT_FD;
        stdio[o->as].data.fd = o->given;
    }
    char home[4096];
    snprintf(home, sizeof home, "HOME=%s", o->folder);
    char **env = environment(home, o->environment);
    const uv_process_options_t options = {.exit_cb = on_exit_of,
                                          .file = o->args[0],
                                          .args = (char **)o->args,
                                          .env = env,
                                          .cwd = o->folder,
                                          .flags = UV_PROCESS_DETACHED,
                                          .stdio = stdio,
                                          .stdio_count = DESCRIPTORS};
    int result = uv_spawn(loop, &p->child, &options);
    free(env);
    p->running = result == 0;
    if (!result)
        result = uv_read_start((uv_stream_t *)&p->errors, on_room, on_errors);
    if (!result)
        return p;
    error_set(e, ERROR_FILM_FAILED, "%s cannot be started: %s", o->args[0], uv_strerror(result));
    film_process_close(p);
    return NULL;
}

static void on_written(uv_write_t *request, int status) {
    struct writing *w = request->data;
    w->done(w->ctx, status);
    free(w);
}

void film_process_write(struct film_process *p, const void *bytes, size_t size,
                        void (*done)(void *ctx, int status), void *ctx) {
    struct writing *w = mem_alloc(sizeof *w);
    *w = (struct writing){.request.data = w, .done = done, .ctx = ctx};
    uv_buf_t all = uv_buf_init((char *)bytes, (unsigned)size);
    int result = uv_write(&w->request, (uv_stream_t *)&p->input, &all, 1, on_written);
    if (result < 0)
        on_written(&w->request, result);
}

void film_process_end_input(struct film_process *p) {
    if (!uv_is_closing((uv_handle_t *)&p->input))
        uv_close((uv_handle_t *)&p->input, on_closed);
}

const char *film_process_said(const struct film_process *p) {
    return p->said;
}

void film_process_interrupt(struct film_process *p) {
    if (p->running)
        uv_kill(p->child.pid, SIGTERM);
}

void film_process_close(struct film_process *p) {
    if (!p)
        return;
    p->closed = true;
    if (p->running)
        uv_kill(-p->child.pid, SIGKILL);
    film_process_end_input(p);
    uv_close((uv_handle_t *)&p->errors, on_closed);
    uv_close((uv_handle_t *)&p->child, on_closed);
}
