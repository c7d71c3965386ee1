/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli_file.h"
#include "server/app/cli.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int complain(const char *path, int error) {
    cli_complain("%s: %s", path, strerror(error));
    return -1;
}

/* In the same folder, and hidden there. */
static char *part_name(const char *place) {
    const char *slash = strrchr(place, '/'), *name = slash ? slash + 1 : place;
    size_t size = strlen(place) + 32;
    char *part = mem_alloc(size);
    snprintf(part, size, "%.*s.%.200s.%ld.part", (int)(name - place), place, name, (long)getpid());
    return part;
}

/* A file without a name goes with the process that is killed; not every file system has such. */
static int open_nameless(const char *place) {
    char *copy = mem_strdup(place);
    int fd = open(dirname(copy), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    free(copy);
    return fd;
}

static int open_part(struct cli_file *f, const struct stat *old) {
    int fd = open_nameless(f->place);
    if (fd < 0) {
        f->part = part_name(f->place);
        fd = open(f->part, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    }
    if (fd >= 0 && old)
        fchmod(fd, old->st_mode & 07777);
    return fd;
}

int cli_create(struct cli_file *f, const char *path) {
    struct stat status;
    *f = (struct cli_file){.path = path};
    if (!strcmp(path, "-")) {
        f->file = stdout;
        return 0;
    }
    bool is_there = !stat(path, &status);
    if (is_there && S_ISDIR(status.st_mode))
        return complain(path, EISDIR);
    int fd;
    if (is_there && !S_ISREG(status.st_mode)) {
        fd = open(path, O_WRONLY | O_CLOEXEC);
    } else {
        f->place = is_there ? realpath(path, NULL) : mem_strdup(path);
        fd = is_there && access(path, W_OK) ? -1 : f->place ? open_part(f, is_there ? &status : NULL) : -1;
    }
    f->file = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (f->file)
        return 0;
    int error = errno;
    if (fd >= 0)
        close(fd);
    free(f->place);
    free(f->part);
    *f = (struct cli_file){0};
    return complain(path, error);
}

/* It gets the name by which it can be moved. */
static int give_name(struct cli_file *f) {
    char self[64];
    if (f->part)
        return 0;
    snprintf(self, sizeof self, "/proc/self/fd/%d", fileno(f->file));
    f->part = part_name(f->place);
    if (!linkat(AT_FDCWD, self, AT_FDCWD, f->part, AT_SYMLINK_FOLLOW))
        return 0;
    int error = errno;
    free(f->part);
    f->part = NULL;
    errno = error;
    return -1;
}

int cli_finish(struct cli_file *f, bool well) {
    int error = 0;
    if (!f->file)
        return 0;
    if (ferror(f->file) || fflush(f->file))
        error = errno ? errno : EIO;
    bool keep = well && !error && f->place;
    if (keep && (give_name(f) || rename(f->part, f->place)))
        error = errno;
    if (f->part && (!keep || error))
        unlink(f->part);
    if (f->file != stdout && fclose(f->file) && !error)
        error = errno;
    if (error && well)
        complain(f->path, error);
    free(f->place);
    free(f->part);
    *f = (struct cli_file){0};
    return error || !well ? -1 : 0;
}
