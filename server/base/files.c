/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/files.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Opens one path component at a time, without following links. */
static int open_slowly(int folder, const char *path, int flags) {
    char name[NAME_MAX + 1];
    int at = dup(folder);
    while (at >= 0) {
        size_t length = strcspn(path, "/");
        bool last = !path[length];
        if (length > NAME_MAX || !length || (length == 2 && !memcmp(path, "..", 2))) {
            close(at);
            errno = length > NAME_MAX ? ENAMETOOLONG : EXDEV;
            return -1;
        }
        memcpy(name, path, length);
        name[length] = '\0';
        int next =
            openat(at, name, O_NOFOLLOW | O_CLOEXEC | (last ? flags | O_NONBLOCK : O_RDONLY | O_DIRECTORY));
        int why = errno;
        close(at);
        errno = why;
        if (last)
            return next;
        at = next;
        path += length + 1;
    }
    return -1;
}

/* resolve: RESOLVE_ flags of openat2. */
static int open_resolved(int folder, const char *path, int flags, uint64_t resolve) {
    const struct open_how how = {.flags = (uint64_t)(flags | O_CLOEXEC | O_NONBLOCK), .resolve = resolve};
    int fd = -1;
    /* EAGAIN: a part of the path was renamed concurrently */
    for (int tries = 0; tries < 8 && fd < 0 && (!tries || errno == EAGAIN); tries++)
        fd = (int)syscall(SYS_openat2, folder, path, &how, sizeof how);
    if (fd < 0 && (errno == ENOSYS || errno == EPERM))
        return open_slowly(folder, path, flags);
    return fd;
}

int open_below_at(int folder, const char *path, int flags) {
    return open_resolved(folder, path, flags, RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS);
}

int open_without_links(const char *path, int flags) {
    int root = open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (root < 0)
        return -1;
    int fd = open_resolved(root, path + strspn(path, "/"), flags, RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS);
    int why = errno;
    close(root);
    errno = why;
    return fd;
}

int open_below(const char *folder, const char *path, int flags) {
    int at = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (at < 0)
        return -1;
    int fd = open_below_at(at, path, flags), why = errno;
    close(at);
    errno = why;
    return fd;
}

FILE *open_file_below(const char *folder, const char *path) {
    struct stat info;
    int fd = open_below(folder, path, O_RDONLY);
    FILE *file = NULL;
    int why = errno;
    if (fd >= 0 && (fstat(fd, &info) || !S_ISREG(info.st_mode)))
        why = EINVAL;
    else if (fd >= 0 && (file = fdopen(fd, "rb")))
        return file;
    if (fd >= 0)
        close(fd);
    errno = why;
    return NULL;
}

bool error_is_outside(int error) {
    return error == EXDEV || error == ELOOP;
}

bool path_leads_outside(const char *folder, const char *path) {
    int fd = open_below(folder, path, O_RDONLY), why = errno;
    if (fd >= 0)
        close(fd);
    return fd < 0 && error_is_outside(why);
}

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
