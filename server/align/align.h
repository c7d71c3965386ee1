/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the moments of a reference (synthetic speech, whose times are known) lie in a recording of the same
 * text. */
#ifndef FACCIA_ALIGN_ALIGN_H
#define FACCIA_ALIGN_ALIGN_H

#include "server/align/warp.h"

struct align_sound {
    const int16_t *pcm; /* mono */
    size_t samples;
    uint32_t rate; /* Hz */
};

struct align_map {
    size_t *at; /* of the reference's frame j: the frame of the recording at which it begins */
    size_t frames;
    uint32_t recording_rate, reference_rate;
    size_t recording_samples;
    double distance; /* mean along the path: about 3 for the same words, 5 and more for others */
};

/* words: samples of the reference at which words begin, in order; there the recording may pause. open_end:
 * the recording may go on after the reference's end. -1 when the recording is far too short. */
int align_make(struct align_map *map, const struct align_sound *recording,
               const struct align_sound *reference, const uint64_t *words, size_t word_count, bool open_end);
void align_free(struct align_map *map);

/* The sample of the recording that a sample of the reference is. Never decreases with it. */
uint64_t align_time(const struct align_map *map, uint64_t reference_sample);

#endif
