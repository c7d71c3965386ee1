/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/publish/spool.h"
#include <errno.h>
#include <sndfile.h>
#include <stdlib.h>
#include <unistd.h>

struct spool_sound {
    struct spool *spool;
    sf_count_t at, size; /* bytes from the spool's end on */
    SNDFILE *file;
    int failed; /* errno */
};

static sf_count_t length_of(void *self) {
    return ((struct spool_sound *)self)->size;
}

static sf_count_t seek_to(sf_count_t offset, int whence, void *self) {
    struct spool_sound *s = self;
    sf_count_t from = whence == SEEK_CUR ? s->at : whence == SEEK_END ? s->size : 0;
    if (from + offset < 0)
        return -1;
    return s->at = from + offset;
}

static sf_count_t read_some(void *to, sf_count_t count, void *self) {
    struct spool_sound *s = self;
    ssize_t n = pread(s->spool->file, to, (size_t)count, (off_t)s->spool->end + s->at);
    s->at += n > 0 ? n : 0;
    return n > 0 ? n : 0;
}

static sf_count_t write_some(const void *from, sf_count_t count, void *self) {
    struct spool_sound *s = self;
    ssize_t n = pwrite(s->spool->file, from, (size_t)count, (off_t)s->spool->end + s->at);
    if (n != count)
        s->failed = n < 0 ? errno : ENOSPC;
    s->at += n > 0 ? n : 0;
    if (s->at > s->size)
        s->size = s->at;
    return n > 0 ? n : 0;
}

static sf_count_t where(void *self) {
    return ((struct spool_sound *)self)->at;
}

struct spool_sound *spool_sound_open(struct spool *spool, uint32_t rate) {
    static const SF_VIRTUAL_IO io = {length_of, seek_to, read_some, write_some, where};
    SF_INFO info = {
        .samplerate = (int)rate, .channels = 1, .format = SF_FORMAT_MPEG | SF_FORMAT_MPEG_LAYER_III};
    struct spool_sound *s = mem_alloc(sizeof *s);
    s->spool = spool;
    s->file = sf_open_virtual((SF_VIRTUAL_IO *)&io, SFM_WRITE, &info, s);
    if (!s->file) {
        free(s);
        errno = ENOTSUP; /* a libsndfile without MP3 */
        return NULL;
    }
    return s;
}

int spool_sound_add(struct spool_sound *s, const int16_t *pcm, uint32_t samples) {
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

int spool_sound_end(struct spool_sound *s, struct spool_piece *piece) {
    int failed = sf_close(s->file) && !s->failed ? EIO : s->failed;
    *piece = (struct spool_piece){s->spool, s->spool->end, (uint64_t)s->size};
    s->spool->end += (uint64_t)s->size;
    free(s);
    errno = failed;
    return failed ? -1 : 0;
}
