/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/publish/temp_file.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int temp_file_open(struct temp_file *s, const char *beside) {
    char *copy = mem_strdup(beside), *folder = dirname(copy);
    s->end = 0;
    s->file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (s->file < 0 &&
        (errno == EOPNOTSUPP || errno == EISDIR)) { /* not every file system supports unnamed files */
        size_t size = strlen(folder) + 32;
        char *name = mem_alloc(size);
        snprintf(name, size, "%s/.faccia-XXXXXX", folder);
        s->file = mkostemp(name, O_CLOEXEC);
        if (s->file >= 0)
            unlink(name);
        free(name);
    }
    int why = errno;
    free(copy);
    errno = why;
    return s->file >= 0 ? 0 : -1;
}

void temp_file_close(struct temp_file *s) {
    if (s->file >= 0)
        close(s->file);
    s->file = -1;
}

int temp_file_add(struct temp_file *s, const struct buf *data, struct temp_piece *piece) {
    *piece = (struct temp_piece){s, s->end, data->size};
    for (size_t done = 0; done < data->size;) {
        ssize_t n = pwrite(s->file, data->data + done, data->size - done, (off_t)(s->end + done));
        if (n < 0 && errno != EINTR)
            return -1;
        done += n > 0 ? (size_t)n : 0;
    }
    s->end += data->size;
    return 0;
}
