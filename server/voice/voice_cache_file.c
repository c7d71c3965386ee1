/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_cache_file.h"
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *const cache_file_ends[4] = {"", "-wal", "-shm", "-journal"};

/* The header of an SQLite database. */
enum { HEADER_BYTES = 100, ID_AT = 68 };
static const char magic[16] = "SQLite format 3";

/* Without waiting, should it be a pipe. */
static const char *complaint(const char *file) {
    uint8_t header[HEADER_BYTES];
    struct stat info;
    int fd = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0)
        return errno == EACCES ? "may not be read" : NULL; /* it is not there */
    ssize_t n = fstat(fd, &info) || !S_ISREG(info.st_mode) ? -1 : pread(fd, header, sizeof header, 0);
    close(fd);
    if (n == 0)
        return NULL;
    if (n != HEADER_BYTES || memcmp(header, magic, sizeof magic) != 0)
        return "is no cache of sentences";
    uint32_t id = (uint32_t)header[ID_AT] << 24 | (uint32_t)header[ID_AT + 1] << 16 |
                  (uint32_t)header[ID_AT + 2] << 8 | header[ID_AT + 3];
    return id == CACHE_FILE_ID ? NULL : "is a database of something else";
}

int cache_file_check(const char *file, struct error *e) {
    const char *why = complaint(file);
    return why ? error_in_field(e, ERROR_BAD_CACHE, "--cache-file",
                                "%.120s %s; it stays as it is: name another file, or remove it", file, why)
               : 0;
}

void cache_file_prepare(const char *file) {
    char path[4096];
    int fd = open(file, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd >= 0)
        close(fd);
    for (size_t i = 0; i < sizeof cache_file_ends / sizeof *cache_file_ends; i++) {
        snprintf(path, sizeof path, "%s%s", file, cache_file_ends[i]);
        chmod(path, 0600);
    }
}
