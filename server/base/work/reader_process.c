/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/work/reader_process.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum { LOOK_MS = 50, ARGUMENTS_MAX = 12, CLOCK_FACTOR = 10 };

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

/* Starts the process with default signal handling, in its own process group, so that the parent's signals
 * do not reach it. */
static int spawn(pid_t *pid, int in, int out, char *const args[]) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t how;
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    posix_spawn_file_actions_init(&files);
    if (in < 0)
        posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    else
        posix_spawn_file_actions_adddup2(&files, in, 0);
    posix_spawn_file_actions_adddup2(&files, out, 1);
    posix_spawnattr_init(&how);
    posix_spawnattr_setsigmask(&how, &none);
    posix_spawnattr_setsigdefault(&how, &usual);
    posix_spawnattr_setpgroup(&how, 0);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    int result = posix_spawn(pid, args[0], &files, &how, args, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    return result;
}

void reader_process_go_on(struct reader_process *p, unsigned seconds) {
    p->patience = seconds;
    p->until = now() + (uint64_t)seconds * 1000;
}

int reader_process_start(struct reader_process *p, const struct reader *reader,
                         const struct reader_limits *limits, const char *const args[], int input,
                         const atomic_bool *given_up, struct error *e) {
    char seconds[16], megabytes[16];
    const char *all[ARGUMENTS_MAX] = {reader->program, seconds, megabytes, reader->unconfined ? "off" : "on"};
    int ends[2];
    *p = (struct reader_process){.fd = -1, .limits = *limits, .given_up = given_up};
    snprintf(seconds, sizeof seconds, "%u", limits->seconds);
    snprintf(megabytes, sizeof megabytes, "%u", limits->megabytes);
    for (size_t i = 0; args[i] && i + 5 < ARGUMENTS_MAX; i++)
        all[i + 4] = args[i];
    int result = pipe2(ends, O_CLOEXEC) ? errno : 0;
    if (!result) {
        result = spawn(&p->pid, input, ends[1], (char *const *)all);
        close(ends[1]);
        if (result)
            close(ends[0]);
        else
            p->fd = ends[0];
    }
    reader_process_go_on(p, limits->seconds * CLOCK_FACTOR);
    if (!result)
        return 0;
    p->pid = 0;
    return error_set(e, ERROR_BAD_WORK, "%.150s cannot be started: %.80s", reader->program, strerror(result));
}

static bool is_wanted(const struct reader_process *p) {
    return !(p->given_up && atomic_load(p->given_up));
}

bool reader_process_read(struct reader_process *p, void *data, size_t size) {
    char *at = data;
    while (size) {
        struct pollfd ready = {p->fd, POLLIN, 0};
        int found = poll(&ready, 1, LOOK_MS);
        if (!is_wanted(p) || now() > p->until)
            return false;
        ssize_t got = found > 0 ? read(p->fd, at, size) : 0;
        if (got < 0 && errno == EINTR)
            got = 0;
        else if (got < 0 || (found > 0 && !got))
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

/* True if the process closed its output, mostly as it exits. */
static bool has_closed(struct reader_process *p) {
    char more;
    struct pollfd ready = {p->fd, POLLIN, 0};
    return poll(&ready, 1, 0) > 0 && read(p->fd, &more, 1) == 0;
}

int reader_process_end(struct reader_process *p, char *why, size_t cap) {
    const unsigned patience = p->patience;
    int status = 0;
    if (!p->pid)
        return -1;
    bool wanted = is_wanted(p), late = now() > p->until, closed = has_closed(p);
    kill(p->pid, SIGKILL); /* changes nothing of an exit that has begun */
    close(p->fd);
    while (waitpid(p->pid, &status, 0) < 0 && errno == EINTR)
        continue;
    *p = (struct reader_process){.fd = -1, .limits = p->limits};
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (!wanted)
        snprintf(why, cap, "its result is no longer needed");
    else if (late)
        snprintf(why, cap, "took more than %u s", patience);
    else if (signal == SIGKILL && closed)
        snprintf(why, cap, "was killed, or closed its output and went on");
    else if (signal == SIGXCPU || signal == SIGKILL)
        snprintf(why, cap, "took more than %u s of processor time", p->limits.seconds);
    else if (signal)
        snprintf(why, cap, "ended its process, by signal %d (%s), or took more than %u MB", signal,
                 strsignal(signal), p->limits.megabytes);
    else if (WEXITSTATUS(status))
        snprintf(why, cap, "ended its process, with status %d", WEXITSTATUS(status));
    return WIFEXITED(status) && !WEXITSTATUS(status) ? 0 : -1;
}

int reader_input(const void *data, size_t size) {
    int fd = memfd_create("input", MFD_CLOEXEC);
    const char *at = data;
    while (fd >= 0 && size) {
        ssize_t put = write(fd, at, size);
        if (put < 0 && errno == EINTR)
            continue;
        if (put <= 0) {
            close(fd);
            return -1;
        }
        at += put;
        size -= (size_t)put;
    }
    if (fd >= 0)
        lseek(fd, 0, SEEK_SET);
    return fd;
}
