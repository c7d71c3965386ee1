/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/sound/memory_file.h"
#include <string.h>

static sf_count_t get_size(void *ctx) {
    return ((struct memory_file *)ctx)->size;
}

static sf_count_t seek(sf_count_t offset, int whence, void *ctx) {
    struct memory_file *m = ctx;
    sf_count_t to = offset + (whence == SEEK_CUR ? m->at : whence == SEEK_END ? m->size : 0);
    m->at = to < 0 ? 0 : to > m->size ? m->size : to;
    return m->at;
}

static sf_count_t get(void *out, sf_count_t count, void *ctx) {
    struct memory_file *m = ctx;
    if (count > m->size - m->at)
        count = m->size - m->at;
    if (count > 0)
        memcpy(out, m->data + m->at, (size_t)count);
    m->at += count;
    return count;
}

static sf_count_t put(const void *data, sf_count_t count, void *ctx) {
    (void)data, (void)count, (void)ctx;
    return 0;
}

static sf_count_t tell(void *ctx) {
    return ((struct memory_file *)ctx)->at;
}

SNDFILE *memory_file_open(struct memory_file *file, SF_INFO *info) {
    SF_VIRTUAL_IO io = {get_size, seek, get, put, tell};
    file->at = 0;
    return sf_open_virtual(&io, SFM_READ, info, file);
}
