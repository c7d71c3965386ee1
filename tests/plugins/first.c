/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Built for the first version of the interface, which could not declare needs: it opens a socket and starts a
 * process, or fails to start. */
#include "tests/plugins/stub.h"
#include <stdio.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static int stub_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)self;
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    pid_t child = fork();
    if (child == 0)
        execl("/bin/true", "true", (char *)NULL);
    if (child == 0)
        _exit(1);
    int status = 0;
    if (child > 0)
        waitpid(child, &status, 0);
    if (fd >= 0)
        close(fd);
    snprintf(message, cap, "it is locked in");
    return fd < 0 || child < 0 || status ? -1 : 0;
}

STUB_TABLE(1);
