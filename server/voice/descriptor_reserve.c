/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/descriptor_reserve.h"
#include <fcntl.h>
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
