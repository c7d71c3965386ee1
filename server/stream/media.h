/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a stream gives out: the samples of an interval and the frames of the same interval, as they are; how
 * they are coded is the matter of codec/. */
#ifndef FACCIA_STREAM_MEDIA_H
#define FACCIA_STREAM_MEDIA_H

#include "protocol/fap.h"
#include <stdint.h>

/* Pointers are good during the call that hands it on. */
struct media {
    uint32_t utterance;   /* 0: of none */
    uint32_t sample_rate; /* Hz */
    double fps;           /* 1..120, whole hundredths */
    uint32_t start;       /* first sample, counted from the utterance's beginning */
    uint32_t samples;     /* duration */
    const int16_t *pcm;   /* NULL: silence */
    uint32_t first_frame; /* number of the first frame, counted in the same way */
    uint32_t frame_count;
    struct fap_frame *frames;
};

#endif
