/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/publish/temp_file.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zip.h>

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

struct reading {
    struct temp_piece piece;
    uint64_t at;
    zip_error_t error;
};

static zip_int64_t read_piece(struct reading *r, void *data, zip_uint64_t size) {
    uint64_t left = r->piece.size - r->at;
    ssize_t n = pread(r->piece.temp->file, data, size < left ? size : left, (off_t)(r->piece.start + r->at));
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

int temp_file_to_zip(const struct temp_piece *piece, struct zip *zip, const char *name, bool packed) {
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

struct temp_sound {
    struct temp_file *temp;
    sf_count_t at, size; /* bytes from the end of the file's finished pieces */
    SNDFILE *file;
    int failed; /* errno */
};

static sf_count_t length_of(void *self) {
    return ((struct temp_sound *)self)->size;
}

static sf_count_t seek_to(sf_count_t offset, int whence, void *self) {
    struct temp_sound *s = self;
    sf_count_t from = whence == SEEK_CUR ? s->at : whence == SEEK_END ? s->size : 0;
    if (from + offset < 0)
        return -1;
    return s->at = from + offset;
}

static sf_count_t read_some(void *to, sf_count_t count, void *self) {
    struct temp_sound *s = self;
    ssize_t n = pread(s->temp->file, to, (size_t)count, (off_t)s->temp->end + s->at);
    s->at += n > 0 ? n : 0;
    return n > 0 ? n : 0;
}

static sf_count_t write_some(const void *from, sf_count_t count, void *self) {
    struct temp_sound *s = self;
    ssize_t n = pwrite(s->temp->file, from, (size_t)count, (off_t)s->temp->end + s->at);
    if (n != count)
        s->failed = n < 0 ? errno : ENOSPC;
    s->at += n > 0 ? n : 0;
    if (s->at > s->size)
        s->size = s->at;
    return n > 0 ? n : 0;
}

static sf_count_t where(void *self) {
    return ((struct temp_sound *)self)->at;
}

struct temp_sound *temp_sound_open(struct temp_file *temp, uint32_t rate) {
    static const SF_VIRTUAL_IO io = {length_of, seek_to, read_some, write_some, where};
    SF_INFO info = {
        .samplerate = (int)rate, .channels = 1, .format = SF_FORMAT_MPEG | SF_FORMAT_MPEG_LAYER_III};
    struct temp_sound *s = mem_alloc(sizeof *s);
    s->temp = temp;
    s->file = sf_open_virtual((SF_VIRTUAL_IO *)&io, SFM_WRITE, &info, s);
    if (!s->file) {
        free(s);
        errno = ENOTSUP; /* libsndfile was built without MP3 */
        return NULL;
    }
    return s;
}

int temp_sound_add(struct temp_sound *s, const int16_t *pcm, uint32_t samples) {
    static const int16_t silence[4096];
    for (uint32_t done = 0; done < samples && !s->failed;) {
        uint32_t size = pcm || samples - done < 4096 ? samples - done : 4096;
        if (sf_write_short(s->file, pcm ? pcm + done : silence, size) != (sf_count_t)size && !s->failed)
            s->failed = EIO;
        done += size;
    }
    errno = s->failed;
    return s->failed ? -1 : 0;
}

int temp_sound_end(struct temp_sound *s, struct temp_piece *piece) {
    int failed = sf_close(s->file) && !s->failed ? EIO : s->failed;
    *piece = (struct temp_piece){s->temp, s->temp->end, (uint64_t)s->size};
    s->temp->end += (uint64_t)s->size;
    free(s);
    errno = failed;
    return failed ? -1 : 0;
}
