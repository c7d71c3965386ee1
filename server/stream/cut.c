/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/cut.h"
#include <math.h>

void cut_chunk(struct cut *cut, const struct scene *scene, double fps, uint32_t samples, struct chunk *chunk,
               struct fap_frame *frames) {
    const struct utterance *u = scene->utterance;
    if (samples > u->samples - cut->at)
        samples = u->samples - cut->at;
    uint64_t start = (uint64_t)scene->start + cut->at;
    uint32_t first = frame_from_sample(start, u->sample_rate, fps);
    uint32_t end = frame_from_sample(start + samples, u->sample_rate, fps);
    for (uint32_t k = first; k < end; k++)
        scene_frame(scene, fps, k, &frames[k - first]);
    *chunk = (struct chunk){
        .audio_codec = CHUNK_AUDIO_PCM_S16LE,
        .fap_codec = CHUNK_FAP_PLAIN,
        .sample_rate = u->sample_rate,
        .fps_hundreds = (uint16_t)lround(fps * 100),
        .frame_count = (uint16_t)(end - first),
        .start = (uint32_t)start,
        .samples = samples,
        .first_frame = first,
        .audio_bytes = samples * 2,
        .audio = (const uint8_t *)(u->pcm + cut->at), /* little-endian hosts only: see meson.build */
    };
    cut->at += samples;
}
