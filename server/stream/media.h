/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of a stream: samples of an interval with the frames of the same interval, not yet encoded (see
 * codec/). */
#ifndef FACCIA_STREAM_MEDIA_H
#define FACCIA_STREAM_MEDIA_H

#include "protocol/fap.h"
#include <stdint.h>

/* Pointers are valid during the call. */
struct media {
    uint32_t utterance;   /* 0 = idle */
    uint32_t sample_rate; /* Hz */
    double fps;           /* 1..120, whole hundredths */
    uint32_t start;       /* first sample, from the utterance's beginning */
    uint32_t samples;     /* duration */
    const int16_t *pcm;   /* NULL = silence */
    uint32_t first_frame; /* number of the first frame, from the utterance's beginning */
    uint32_t frame_count;
    struct fap_frame *frames;
};

#endif
