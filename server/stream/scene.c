/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/speech.h"
#include <math.h>

void scene_free(struct scene *scene) {
    utterance_free(scene->utterance);
    face_track_free(scene->track);
    *scene = (struct scene){0};
}

void scene_frame(const struct scene *scene, double fps, uint32_t k, struct fap_frame *frame) {
    if (!scene->track) {
        size_t last = scene->frame_count - 1;
        *frame = scene->frame_count ? scene->frames[k < last ? k : last] : (struct fap_frame){0};
        return;
    }
    face_track_sample(scene->track, k / fps - (double)scene->start / scene->utterance->sample_rate, frame);
}

uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps) {
    /* the protocol counts frame rates in hundredths, so this is exact */
    uint64_t hundredths = (uint64_t)llround(fps * 100), per = 100 * (uint64_t)sample_rate;
    return (uint32_t)((sample * hundredths + per - 1) / per);
}
