/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/media_segment.h"
#include <math.h>
#include <stdlib.h>

void media_segment_free(struct media_segment *segment) {
    sentence_audio_free(segment->audio);
    face_track_free(segment->track);
    free(segment->own);
    *segment = (struct media_segment){0};
}

struct face_placement *media_segment_place(const struct media_segment *segment,
                                           const struct placement_options *options) {
    if (segment->mouth)
        return face_placement_new(NULL, NULL, options);
    return segment->track ? face_placement_new(segment->track, segment->audio, options) : NULL;
}

static const struct fap_frame *frame_of(const struct media_segment *segment, uint32_t k) {
    static const struct fap_frame rest;
    size_t at = k > segment->first_frame ? k - segment->first_frame : 0;
    if (!segment->frame_count)
        return &rest;
    return &segment->frames[at < segment->frame_count ? at : segment->frame_count - 1];
}

void media_segment_frame(const struct media_segment *segment, struct face_placement *placement, double fps,
                         uint32_t k, struct fap_frame *frame) {
    if (!placement) {
        *frame = *frame_of(segment, k);
        return;
    }
    if (segment->mouth) {
        face_placement_sample_around(placement, k / fps, frame_of(segment, k), frame);
        return;
    }
    face_placement_sample(placement, k / fps - (double)segment->start / segment->audio->sample_rate, frame);
}

uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps) {
    /* the protocol counts frame rates in hundredths, so this is exact */
    uint64_t hundredths = (uint64_t)llround(fps * 100), per = 100 * (uint64_t)sample_rate;
    return (uint32_t)((sample * hundredths + per - 1) / per);
}
