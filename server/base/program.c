/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/program.h"
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

static const int ignored[] = {SIGPIPE, SIGXFSZ};

/* Opens them for the wrong direction, so that use fails instead of being ignored. open returns the lowest
 * free number. */
static void open_standard_descriptors(void) {
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF && open("/dev/null", fd ? O_RDONLY : O_WRONLY) < 0)
            return; /* no /dev/null: give up */
}

void program_begin(void) {
    sigset_t none;
    open_standard_descriptors();
    for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++)
        signal(ignored[i], SIG_IGN);
    signal(SIGCHLD, SIG_DFL);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    setlocale(LC_CTYPE, "C.UTF-8");
    umask(umask(0) | S_IWOTH);
}

void program_give_back_signals(void) {
    for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++)
        signal(ignored[i], SIG_DFL);
}

void program_end_with_parent(int end, int signal) {
    struct pollfd peer = {.fd = end};
    prctl(PR_SET_PDEATHSIG, signal);
    if (poll(&peer, 1, 0) == 1) /* POLLHUP or POLLERR: the parent has ended */
        _exit(EXIT_FAILURE);
}

void program_end_with(pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(EXIT_FAILURE);
}
