/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/command/run.h"
#include "server/base/program.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { READ_BYTES = 64 << 10, PROGRAM_NOT_FOUND = 127 };

int cm_stop_open(struct cm_stop *stop) {
    stop->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    return stop->wake < 0 ? -1 : 0;
}

void cm_stop_close(struct cm_stop *stop) {
    if (stop->wake >= 0)
        close(stop->wake);
}

void cm_stop_now(struct cm_stop *stop) {
    const uint64_t one = 1;
    atomic_store(&stop->stopped, true);
    if (write(stop->wake, &one, sizeof one) < 0)
        return; /* it is full: woken already */
}

void cm_stop_reset(struct cm_stop *stop) {
    uint64_t count;
    if (read(stop->wake, &count, sizeof count) < 0)
        count = 0;
    atomic_store(&stop->stopped, false);
}

/* The program and the three pipes to it. */
struct child {
    pid_t pid;
    int in, out, complaints;
    char complaint[160]; /* its last whole line */
    char line[160];      /* the one that it is writing */
    size_t length;
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

_Noreturn static void become(const struct cm_run *run, int in, int out, int complaints) {
    const struct rlimit file = {run->bytes, run->bytes};
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    program_give_back_signals();
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    in = fcntl(in, F_DUPFD, 10), out = fcntl(out, F_DUPFD, 10), complaints = fcntl(complaints, F_DUPFD, 10);
    dup2(in, 0);
    dup2(out, 1);
    dup2(complaints, 2);
    close_range(3, ~0u, 0);
    setrlimit(RLIMIT_FSIZE, &file);
    execvp(run->argv[0], run->argv);
    dprintf(2, "%s\n", strerror(errno));
    _exit(PROGRAM_NOT_FOUND);
}

static void shut(int *fd) {
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

static bool start(struct child *child, const struct cm_run *run) {
    int pipes[3][2] = {{-1, -1}, {-1, -1}, {-1, -1}};
    bool open = !pipe2(pipes[0], O_CLOEXEC) && !pipe2(pipes[1], O_CLOEXEC) && !pipe2(pipes[2], O_CLOEXEC);
    child->pid = open ? fork() : -1;
    if (child->pid == 0)
        become(run, pipes[0][0], pipes[1][1], pipes[2][1]);
    shut(&pipes[0][0]), shut(&pipes[1][1]), shut(&pipes[2][1]);
    child->in = pipes[0][1], child->out = pipes[1][0], child->complaints = pipes[2][0];
    if (child->pid < 0)
        return false;
    setpgid(child->pid, child->pid); /* the child does it, too: either may come first */
    fcntl(child->in, F_SETFL, O_NONBLOCK);
    return true;
}

static void end_line(struct child *child) {
    if (child->length)
        snprintf(child->complaint, sizeof child->complaint, "%.*s", (int)child->length, child->line);
    child->length = 0;
}

static void hear_complaint(struct child *child) {
    char text[1024];
    ssize_t n = read(child->complaints, text, sizeof text);
    for (ssize_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c == '\n' || c == '\r')
            end_line(child);
        else if (child->length < sizeof child->line)
            child->line[child->length++] = c < ' ' || c >= 0x7F ? '?' : (char)c;
    }
    if (n <= 0) {
        end_line(child);
        shut(&child->complaints);
    }
}

static void feed(struct child *child, const char **input) {
    ssize_t n = write(child->in, *input, strlen(*input));
    if (n > 0)
        *input += n;
    if (!**input || (n < 0 && errno != EAGAIN && errno != EINTR)) /* a program need not read all */
        shut(&child->in);
}

/* Until the program has closed both of its ends. NULL, or what went wrong. */
static const char *converse(struct child *child, const struct cm_run *run, struct cm_stop *stop,
                            struct buf *out) {
    const double deadline = now() + run->seconds;
    const char *input = run->input ? run->input : "";
    if (!*input)
        shut(&child->in);
    while (child->out >= 0 || child->complaints >= 0) {
        struct pollfd polled[] = {{child->out, POLLIN, 0},
                                  {child->complaints, POLLIN, 0},
                                  {child->in, POLLOUT, 0},
                                  {stop->wake, POLLIN, 0}};
        double left = deadline - now();
        if (atomic_load(&stop->stopped))
            return "was stopped";
        if (left <= 0)
            return "took too long";
        if (poll(polled, 4, (int)(left * 1000) + 1) < 0 && errno != EINTR)
            return "cannot be heard";
        if (polled[1].revents)
            hear_complaint(child);
        if (polled[2].revents)
            feed(child, &input);
        if (!polled[0].revents)
            continue;
        ssize_t n = read(child->out, buf_reserve(out, READ_BYTES), READ_BYTES);
        if (n <= 0)
            shut(&child->out);
        else
            out->size += (size_t)n;
        if (out->size > run->bytes)
            return "wrote too much";
    }
    return NULL;
}

/* Waits for the end of a program that has nothing to say any more. */
static const char *await_end(struct child *child, double deadline, struct cm_stop *stop, int *status) {
    while (waitpid(child->pid, status, WNOHANG) == 0) {
        if (atomic_load(&stop->stopped))
            return "was stopped";
        if (now() > deadline)
            return "took too long";
        usleep(1000);
    }
    child->pid = 0;
    return NULL;
}

enum cm_result cm_run(const struct cm_run *run, struct cm_stop *stop, struct buf *out, char *message,
                      size_t cap) {
    struct child child = {.in = -1, .out = -1, .complaints = -1};
    char how[48] = "";
    int status = 0;
    double deadline = now() + run->seconds;
    const char *wrong = start(&child, run) ? converse(&child, run, stop, out) : "cannot be started";
    if (!wrong)
        wrong = await_end(&child, deadline, stop, &status);
    if (child.pid > 0) {
        kill(-child.pid, SIGKILL);
        waitpid(child.pid, NULL, 0);
    }
    shut(&child.in), shut(&child.out), shut(&child.complaints);
    end_line(&child);
    if (!wrong && WIFSIGNALED(status))
        snprintf(how, sizeof how, "was killed by signal %d", WTERMSIG(status));
    else if (!wrong && WEXITSTATUS(status) == PROGRAM_NOT_FOUND)
        snprintf(how, sizeof how, "cannot be started");
    else if (!wrong && WEXITSTATUS(status))
        snprintf(how, sizeof how, "exited with status %d", WEXITSTATUS(status));
    if (!wrong && !*how)
        return CM_DONE;
    snprintf(message, cap, "\"%.60s\" %s%s%s", run->argv[0], wrong ? wrong : how,
             *child.complaint ? ": " : "", child.complaint);
    return atomic_load(&stop->stopped) ? CM_STOPPED : CM_FAILED;
}
