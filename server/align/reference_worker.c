/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/reference_worker.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define CODE ERROR_NO_REFERENCE
enum { READ_BYTES = 64 << 10 };

extern char **environ;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* With nothing to read, and its output as complaints. */
static int spawn(pid_t *pid, int fd, const char *program, const char *plugin) {
    char *args[] = {(char *)program, (char *)plugin, NULL};
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, 2, 1);
    posix_spawn_file_actions_adddup2(&files, fd, WIRE_FD);
    int result = posix_spawn(pid, program, &files, NULL, args, environ);
    posix_spawn_file_actions_destroy(&files);
    return result;
}

/* Sends the spawner the other end of the socket. */
static int ask_spawner(int fd) {
    union {
        struct cmsghdr header;
        char room[CMSG_SPACE(sizeof fd)];
    } control = {.room = {0}};
    char byte = 0;
    struct iovec data = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control.room};
    struct cmsghdr *part = CMSG_FIRSTHDR(&message);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SCM_RIGHTS;
    part->cmsg_len = CMSG_LEN(sizeof fd);
    memcpy(CMSG_DATA(part), &fd, sizeof fd);
    return sendmsg(WIRE_SPAWNER_FD, &message, MSG_NOSIGNAL) < 0 ? errno : 0;
}

int reference_worker_start(struct reference_worker *w, const char *program, const char *plugin,
                           struct error *e) {
    int ends[2];
    *w = (struct reference_worker){.fd = -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return error_set(e, CODE, "no voice to align to: no socket (%s)", strerror(errno));
    int result = *program ? spawn(&w->pid, ends[1], program, plugin) : ask_spawner(ends[1]);
    close(ends[1]);
    if (!result) {
        w->fd = ends[0];
        return 0;
    }
    close(ends[0]);
    w->pid = 0;
    return error_set(e, CODE, "no voice to align to: %.180s cannot be started (%s)",
                     *program ? program : "a worker", strerror(result));
}

void reference_worker_stop(struct reference_worker *w) {
    if (w->fd >= 0)
        close(w->fd);
    while (w->pid && waitpid(w->pid, NULL, 0) < 0 && errno == EINTR)
        continue;
    buf_free(&w->in);
    *w = (struct reference_worker){.fd = -1};
}

static int lost(struct reference_worker *w, const char *why, struct error *e) {
    reference_worker_stop(w);
    return error_set(e, CODE, "the voice to align to %s", why);
}

int reference_worker_send(struct reference_worker *w, struct buf *b, struct error *e) {
    for (size_t at = 0; at < b->size;) {
        ssize_t n = send(w->fd, b->data + at, b->size - at, MSG_NOSIGNAL);
        if (n < 0 && errno != EINTR)
            return lost(w, "has ended", e);
        at += n > 0 ? (size_t)n : 0;
    }
    b->size = 0;
    return 0;
}

static int read_more(struct reference_worker *w, double until, struct error *e) {
    struct pollfd socket = {.fd = w->fd, .events = POLLIN};
    double left = until - now();
    int ready = poll(&socket, 1, left > 0 ? (int)(left * 1000) + 1 : 0);
    if (!ready)
        return lost(w, "is silent", e);
    ssize_t n = ready < 0 ? -1 : read(w->fd, buf_reserve(&w->in, READ_BYTES), READ_BYTES);
    if (n == 0 || (n < 0 && errno != EINTR))
        return lost(w, "has ended", e);
    w->in.size += n > 0 ? (size_t)n : 0;
    return 0;
}

int reference_worker_hear(struct reference_worker *w, struct wire_frame *frame, double seconds,
                          struct error *e) {
    double until = now() + seconds;
    for (;;) {
        buf_consume(&w->in, w->used);
        w->used = 0;
        int found = wire_next(w->in.data, w->in.size, frame, &w->used);
        if (found < 0)
            return lost(w, "sent garbage", e);
        if (found && frame->type != WIRE_ALIVE)
            return 0;
        if (!found && read_more(w, until, e))
            return -1;
    }
}
