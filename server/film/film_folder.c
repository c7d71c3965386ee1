/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_folder.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { NEW_SECONDS = 60 }; /* a folder that new may not be locked yet */

static int remove_one(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status;
    (void)kind;
    (void)place;
    remove(path);
    return 0;
}

static void remove_all(const char *path) {
    enum { TRIES = 20, PAUSE_US = 50000 };
    /* A browser that was killed may still write for a moment. */
    for (int i = 0; i < TRIES && !access(path, F_OK); i++) {
        if (i)
            usleep(PAUSE_US);
        nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    }
}

static int lock(const char *path) {
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd >= 0 && !flock(fd, LOCK_EX | LOCK_NB))
        return fd;
    if (fd >= 0)
        close(fd);
    return -1;
}

static void remove_left(const char *path) {
    struct stat status;
    int fd = lock(path);
    if (fd < 0)
        return;
    if (!fstat(fd, &status) && status.st_uid == geteuid() && status.st_mtime + NEW_SECONDS < time(NULL))
        remove_all(path);
    close(fd);
}

void film_folder_sweep(const char *prefix) {
    size_t size = strlen(prefix) + sizeof "-??????";
    char *pattern = mem_alloc(size);
    glob_t found;
    snprintf(pattern, size, "%s-??????", prefix);
    if (!strpbrk(prefix, "*?[\\") && !glob(pattern, GLOB_PERIOD, NULL, &found)) {
        for (size_t i = 0; i < found.gl_pathc; i++)
            remove_left(found.gl_pathv[i]);
        globfree(&found);
    }
    free(pattern);
}

int film_folder_make(struct film_folder *folder, const char *prefix) {
    size_t size = strlen(prefix) + sizeof "-XXXXXX";
    char *path = mem_alloc(size);
    film_folder_sweep(prefix);
    snprintf(path, size, "%s-XXXXXX", prefix);
    if (!mkdtemp(path)) {
        int number = errno;
        free(path);
        errno = number;
        return -1;
    }
    *folder = (struct film_folder){path, lock(path)};
    return 0;
}

void film_folder_remove(struct film_folder *folder) {
    if (!folder->path)
        return;
    remove_all(folder->path);
    if (folder->lock >= 0)
        close(folder->lock);
    free(folder->path);
    *folder = (struct film_folder){0};
}
