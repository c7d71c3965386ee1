/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/spool.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zip.h>

int spool_open(struct spool *s, const char *beside) {
    char *copy = mem_strdup(beside), *folder = dirname(copy);
    s->end = 0;
    s->file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (s->file < 0 &&
        (errno == EOPNOTSUPP || errno == EISDIR)) { /* not every file system has nameless files */
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

void spool_close(struct spool *s) {
    if (s->file >= 0)
        close(s->file);
    s->file = -1;
}

int spool_add(struct spool *s, const struct buf *data, struct spool_piece *piece) {
    *piece = (struct spool_piece){s, s->end, data->size};
    for (size_t done = 0; done < data->size;) {
        ssize_t n = pwrite(s->file, data->data + done, data->size - done, (off_t)(s->end + done));
        if (n < 0 && errno != EINTR)
            return -1;
        done += n > 0 ? (size_t)n : 0;
    }
    s->end += data->size;
    return 0;
}

struct reading {
    struct spool_piece piece;
    uint64_t at;
    zip_error_t error;
};

static zip_int64_t read_piece(struct reading *r, void *data, zip_uint64_t size) {
    uint64_t left = r->piece.size - r->at;
    ssize_t n = pread(r->piece.spool->file, data, size < left ? size : left, (off_t)(r->piece.start + r->at));
    if (n < 0)
        zip_error_set(&r->error, ZIP_ER_READ, errno);
    else
        r->at += (uint64_t)n;
    return n;
}

static zip_int64_t on_source(void *self, void *data, zip_uint64_t size, zip_source_cmd_t command) {
    struct reading *r = self;
    switch (command) {
    case ZIP_SOURCE_OPEN:
        r->at = 0;
        return 0;
    case ZIP_SOURCE_READ:
        return read_piece(r, data, size);
    case ZIP_SOURCE_CLOSE:
        return 0;
    case ZIP_SOURCE_STAT: {
        zip_stat_t *stat = data;
        zip_stat_init(stat);
        stat->valid = ZIP_STAT_SIZE;
        stat->size = r->piece.size;
        return (zip_int64_t)sizeof *stat;
    }
    case ZIP_SOURCE_ERROR:
        return zip_error_to_data(&r->error, data, size);
    case ZIP_SOURCE_FREE:
        free(r);
        return 0;
    case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                              ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
    default:
        zip_error_set(&r->error, ZIP_ER_OPNOTSUPP, 0);
        return -1;
    }
}

int spool_to_zip(const struct spool_piece *piece, struct zip *zip, const char *name, bool packed) {
    struct reading *r = mem_alloc(sizeof *r);
    r->piece = *piece;
    zip_source_t *source = zip_source_function(zip, on_source, r);
    if (!source) {
        free(r);
        return -1;
    }
    zip_int64_t number = zip_file_add(zip, name, source, ZIP_FL_ENC_UTF_8);
    if (number < 0) {
        zip_source_free(source);
        return -1;
    }
    return zip_set_file_compression(zip, (zip_uint64_t)number, packed ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
}
