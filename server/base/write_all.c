/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/write_all.h"
#include <errno.h>
#include <unistd.h>

bool write_all(int fd, const void *data, size_t size) {
    const char *at = data;
    while (size) {
        ssize_t put = write(fd, at, size);
        if (put < 0 && errno != EINTR)
            return false;
        at += put > 0 ? put : 0;
        size -= put > 0 ? (size_t)put : 0;
    }
    return true;
}
