/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads any frames of an open sound file, as one channel of 16 bits. */
#ifndef FACCIA_LIBRARY_ALIGN_MONO_READER_H
#define FACCIA_LIBRARY_ALIGN_MONO_READER_H

#include "server/base/sound/mixdown.h"
#include <sndfile.h>
#include <stddef.h>
#include <stdint.h>

enum { MONO_READER_FRAMES = 4096 };

struct mono_reader {
    SNDFILE *file;
    unsigned channels; /* 1 to MIXDOWN_CHANNELS_MAX */
    uint64_t next;     /* the file's next frame */
    struct mixdown mixdown;
    float frames[MONO_READER_FRAMES * MIXDOWN_CHANNELS_MAX];
};

/* Begins with a file that stands at its first frame. The caller closes it. */
void mono_reader_begin(struct mono_reader *reader, SNDFILE *file, int channels);

/* Returns how many of the frames from `from` on there were. */
size_t mono_reader_read(struct mono_reader *reader, uint64_t from, int16_t *out, size_t count);

#endif
