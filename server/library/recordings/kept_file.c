/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/recordings/kept_file.h"
#include "server/base/mem.h"
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int fail(const char *path, struct error *e) {
    return error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", path, strerror(errno));
}

static int path_of(char path[PATH_MAX], const char *folder, const char *work, const char *ending,
                   struct error *e) {
    errno = ENAMETOOLONG;
    return snprintf(path, PATH_MAX - 32, "%s/%s%s", folder, work, ending) < PATH_MAX - 32 ? 0
                                                                                          : fail(folder, e);
}

static bool holds(const char *path, const void *data, size_t size) {
    struct stat info;
    if (stat(path, &info) || (size_t)info.st_size != size)
        return false;
    FILE *file = fopen(path, "rb");
    char *now = mem_alloc(size + 1);
    bool same = file && fread(now, 1, size, file) == size && (!size || !memcmp(now, data, size));
    free(now);
    if (file)
        fclose(file);
    return same;
}

int kept_set(const char *folder, const char *work, const char *ending, const void *data, size_t size,
             struct error *e) {
    char path[PATH_MAX], part[PATH_MAX];
    if (path_of(path, folder, work, ending, e))
        return -1;
    if (holds(path, data, size))
        return 0;
    snprintf(part, sizeof part, "%.*s.%ld.part", PATH_MAX - 32, path, (long)getpid());
    FILE *file = fopen(part, "wb");
    bool well = file && fwrite(data, 1, size, file) == size && !fflush(file) && !fsync(fileno(file));
    if (file && fclose(file))
        well = false;
    if (well && !rename(part, path))
        return 0;
    fail(path, e);
    unlink(part);
    return -1;
}

int kept_set_json(const char *folder, const char *work, const char *ending, const json_t *value,
                  struct error *e) {
    char *text = json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(9));
    int result = kept_set(folder, work, ending, text, strlen(text), e);
    free(text);
    return result;
}

json_t *kept_json(const char *folder, const char *work, const char *ending) {
    char path[PATH_MAX];
    struct error e;
    return path_of(path, folder, work, ending, &e) ? NULL : json_load_file(path, 0, NULL);
}

int64_t kept_time(const struct stat *file) {
    return (int64_t)file->st_mtim.tv_sec * 1000000000 + file->st_mtim.tv_nsec;
}
