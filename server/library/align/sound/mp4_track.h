/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first track of AAC in an MP4 file (ISO 14496-12, 14496-14): where its frames lie. */
#ifndef FACCIA_LIBRARY_ALIGN_MP4_TRACK_H
#define FACCIA_LIBRARY_ALIGN_MP4_TRACK_H

#include "server/base/error.h"
#include <stddef.h>
#include <stdint.h>

struct mp4_frame {
    uint64_t at;
    uint32_t size;
};

struct mp4_track {
    const uint8_t *config; /* AudioSpecificConfig, in the data */
    size_t config_size;
    struct mp4_frame *frames; /* within the data */
    size_t count;
    uint32_t timescale; /* units per second */
    uint64_t skip;      /* units before the sound begins: the delay of the encoder, by the edit list */
    uint64_t length;    /* units of sound after that; 0: all */
};

/* -1 with *e ("bad-sound"). */
int mp4_track_read(struct mp4_track *track, const uint8_t *data, size_t size, struct error *e);
void mp4_track_free(struct mp4_track *track);

#endif
