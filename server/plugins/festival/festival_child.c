/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/program.h"
#include "server/plugins/festival/festival_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ANSWER_FD = 3, READ_BYTES = 64 << 10, LAST_BREATH_MS = 50 };

/* Heap in cells, 56 MB; the default uses 330 MB without being faster. */
#define HEAP "1000000"

int fe_child_open(struct fe_child *child, const char *program, const char *script) {
    *child = (struct fe_child){.program = program, .script = script, .in = -1, .out = -1, .complaints = -1};
    child->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    return child->wake < 0 ? -1 : 0;
}

/* Runs in the child. It ends with the worker, even if that is killed. */
_Noreturn static void become_festival(const char *program, pid_t parent, int in, int out, int complaints) {
    int quiet = open("/dev/null", O_WRONLY);
    struct rlimit time;
    program_end_with(parent);
    getrlimit(RLIMIT_CPU, &time);
    time.rlim_cur =
        time.rlim_max; /* the worker's limit applies per sentence, but Festival lives through many */
    setrlimit(RLIMIT_CPU, &time);
    program_give_back_signals();
    /* out may be one of 0..3: move it away first */
    out = fcntl(out, F_DUPFD, 10);
    complaints = fcntl(complaints, F_DUPFD, 10);
    dup2(in, 0);
    dup2(quiet, 1);
    dup2(complaints, 2);
    dup2(out, ANSWER_FD);
    close_range(ANSWER_FD + 1, ~0u, 0);
    execlp(program, program, "--heap", HEAP, "--pipe", (char *)NULL);
    _exit(127);
}

bool fe_child_start(struct fe_child *child) {
    int in[2], out[2], complaints[2];
    if (child->pid && waitpid(child->pid, NULL, WNOHANG) == 0)
        return true;
    if (child->pid) { /* it died while idle */
        child->pid = 0;
        fe_child_kill(child, NULL, 0);
    }
    if (pipe2(in, O_CLOEXEC) < 0)
        return false;
    if (pipe2(out, O_CLOEXEC) < 0) {
        close(in[0]), close(in[1]);
        return false;
    }
    if (pipe2(complaints, O_CLOEXEC) < 0) {
        close(in[0]), close(in[1]), close(out[0]), close(out[1]);
        return false;
    }
    const pid_t parent = getpid();
    child->pid = fork();
    if (child->pid == 0)
        become_festival(child->program, parent, in[0], out[1], complaints[1]);
    close(in[0]), close(out[1]), close(complaints[1]);
    child->in = in[1], child->out = out[0], child->complaints = complaints[0];
    fcntl(child->in, F_SETFL, O_NONBLOCK);
    fcntl(child->out, F_SETFL, O_NONBLOCK);
    fcntl(child->complaints, F_SETFL, O_NONBLOCK);
    if (child->pid < 0) {
        child->pid = 0;
        fe_child_kill(child, NULL, 0);
        return false;
    }
    struct buf hello = {0};
    buf_printf(&hello, "(load \"%s\")\n", child->script);
    fe_child_send(child, &hello); /* failures show with the first request */
    buf_free(&hello);
    return true;
}

/* Keeps the last non-empty line. */
static void hear_complaints(struct fe_child *child) {
    char text[2048];
    ssize_t n = read(child->complaints, text, sizeof text - 1);
    if (n <= 0)
        return;
    text[n] = '\0';
    for (char *save, *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save))
        if (!strstr(line, "closing a file left open"))
            snprintf(child->complaint, sizeof child->complaint, "%s", line);
    for (char *c = child->complaint; *c; c++)
        if ((unsigned char)*c >= 0x7F || (unsigned char)*c < ' ')
            *c = '?';
}

/* Waits until fd is ready for the events. */
static enum fe_result await(struct fe_child *child, int fd, short events) {
    for (;;) {
        struct pollfd polled[] = {{fd, events, 0}, {child->wake, POLLIN, 0}, {child->complaints, POLLIN, 0}};
        if (atomic_load(&child->cancelled))
            return FE_CANCELLED;
        if (poll(polled, 3, -1) < 0 && errno != EINTR)
            return FE_DIED;
        if (polled[2].revents & POLLIN)
            hear_complaints(child);
        if (polled[0].revents)
            return FE_OK;
        if (polled[2].revents & POLLHUP) /* its output is read and there is nothing else */
            return FE_DIED;
    }
}

enum fe_result fe_child_send(struct fe_child *child, const struct buf *request) {
    for (size_t sent = 0; sent < request->size;) {
        ssize_t n = write(child->in, request->data + sent, request->size - sent);
        if (n > 0) {
            sent += (size_t)n;
            continue;
        }
        if (errno != EAGAIN && errno != EINTR)
            return FE_DIED;
        enum fe_result result = await(child, child->in, POLLOUT);
        if (result != FE_OK)
            return result;
    }
    return FE_OK;
}

static enum fe_result read_more(struct fe_child *child) {
    for (;;) {
        ssize_t n = read(child->out, buf_reserve(&child->answer, READ_BYTES), READ_BYTES);
        if (n > 0) {
            child->answer.size += (size_t)n;
            return FE_OK;
        }
        if (n == 0)
            return FE_DIED;
        if (errno != EAGAIN && errno != EINTR)
            return FE_DIED;
        enum fe_result result = await(child, child->out, POLLIN);
        if (result != FE_OK)
            return result;
    }
}

enum fe_result fe_child_line(struct fe_child *child, const char **line) {
    struct buf *b = &child->answer;
    uint8_t *end;
    while (!b->size || !(end = memchr(b->data + child->taken, '\n', b->size - child->taken))) {
        enum fe_result result = read_more(child);
        if (result != FE_OK)
            return result;
    }
    *end = '\0';
    *line = (const char *)b->data + child->taken;
    child->taken = (size_t)(end + 1 - b->data);
    return FE_OK;
}

enum fe_result fe_child_bytes(struct fe_child *child, size_t size, const void **bytes) {
    struct buf *b = &child->answer;
    buf_consume(b, child->taken);
    child->taken = 0;
    while (b->size < size) {
        enum fe_result result = read_more(child);
        if (result != FE_OK)
            return result;
    }
    *bytes = b->data;
    child->taken = size;
    return FE_OK;
}

static void shut(int *fd) {
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

void fe_child_kill(struct fe_child *child, char *how, size_t cap) {
    int status = 0;
    if (cap)
        *how = '\0';
    if (child->pid) {
        if (child->complaints >= 0)
            hear_complaints(child);
        pid_t ended = waitpid(child->pid, &status, WNOHANG);
        for (int i = 0; cap && ended == 0 && i < LAST_BREATH_MS;
             i++) { /* the pipes close before the process exits */
            usleep(1000);
            ended = waitpid(child->pid, &status, WNOHANG);
        }
        if (ended == 0) {
            kill(child->pid, SIGKILL);
            waitpid(child->pid, NULL, 0);
        } else if (cap && WIFSIGNALED(status)) {
            snprintf(how, cap, "was killed by signal %d", WTERMSIG(status));
        } else if (cap) {
            snprintf(how, cap, "exited with status %d", WEXITSTATUS(status));
        }
    }
    child->pid = 0;
    shut(&child->in);
    shut(&child->out);
    shut(&child->complaints);
    child->answer.size = child->taken = 0;
}

void fe_child_close(struct fe_child *child) {
    fe_child_kill(child, NULL, 0);
    shut(&child->wake);
    buf_free(&child->answer);
}

void fe_child_cancel(struct fe_child *child) {
    const uint64_t one = 1;
    atomic_store(&child->cancelled, true);
    if (write(child->wake, &one, sizeof one) < 0)
        return; /* full: already signalled */
}

void fe_child_begin(struct fe_child *child) {
    uint64_t count;
    if (read(child->wake, &count, sizeof count) < 0)
        count = 0;
    child->complaint[0] = '\0';
    atomic_store(&child->cancelled, false);
}
