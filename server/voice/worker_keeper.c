/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/worker_keeper.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/wire.h"
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

/* The descriptor in the next message; -1 when nobody is there any more, or the message has none. */
static int receive(int socket) {
    union {
        struct cmsghdr header;
        char room[CMSG_SPACE(sizeof(int))];
    } control;
    char byte;
    int fd;
    struct iovec data = {&byte, 1};
    struct msghdr message = {
        .msg_iov = &data, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control.room};
    if (recvmsg(socket, &message, MSG_CMSG_CLOEXEC) <= 0)
        return -1;
    const struct cmsghdr *part = CMSG_FIRSTHDR(&message);
    if (!part || part->cmsg_type != SCM_RIGHTS || part->cmsg_len != CMSG_LEN(sizeof fd))
        return -1;
    memcpy(&fd, CMSG_DATA(part), sizeof fd);
    return fd;
}

/* Becomes a worker. Its number is that of the socket, which dup2 leaves open over exec. */
_Noreturn static void become_worker(int fd, const char *plugin) {
    signal(SIGCHLD, SIG_DFL);
    if (fd == WIRE_FD)
        fcntl(fd, F_SETFD, 0);
    else
        dup2(fd, WIRE_FD);
    execl("/proc/self/exe", "faccia-voice", plugin, (char *)NULL);
    _exit(127); /* its socket ends: the plugin hears that */
}

_Noreturn static void keep(int socket, const char *plugin) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    private_memory();
    signal(SIGCHLD, SIG_IGN); /* nobody waits for workers */
    close(WIRE_FD);           /* the daemon's */
    for (int fd; (fd = receive(socket)) >= 0; close(fd))
        if (fork() == 0)
            become_worker(fd, plugin);
    _exit(0);
}

void worker_keeper_start(const char *plugin) {
    char espeak[PATH_MAX];
    const char *slash = strrchr(plugin, '/');
    int ends[2];
    snprintf(espeak, sizeof espeak, "%.*sespeak.so", slash ? (int)(slash - plugin) + 1 : 0, plugin);
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
        return;
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        keep(ends[1], espeak);
    }
    close(ends[1]);
    if (ends[0] != WIRE_KEEPER_FD) {
        dup3(ends[0], WIRE_KEEPER_FD, O_CLOEXEC);
        close(ends[0]);
    }
    if (child < 0)
        close(WIRE_KEEPER_FD);
}
