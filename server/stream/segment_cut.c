/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/segment_cut.h"
#include <math.h>

void segment_cut_chunk(struct segment_cut *cut, const struct media_segment *segment, double fps,
                       uint32_t samples, struct chunk *chunk, struct fap_frame *frames) {
    const struct sentence_audio *u = segment->audio;
    if (samples > u->samples - cut->at)
        samples = u->samples - cut->at;
    uint64_t start = (uint64_t)(segment->start + cut->at);
    uint32_t first = frame_from_sample(start, u->sample_rate, fps);
    uint32_t end = frame_from_sample(start + samples, u->sample_rate, fps);
    for (uint32_t k = first; k < end; k++)
        media_segment_frame(segment, fps, k, &frames[k - first]);
    *chunk = (struct chunk){
        .audio_codec = u->pcm ? CHUNK_AUDIO_PCM_S16LE : CHUNK_AUDIO_SILENCE,
        .fap_codec = CHUNK_FAP_PLAIN,
        .sample_rate = u->sample_rate,
        .fps_hundreds = (uint16_t)lround(fps * 100),
        .frame_count = (uint16_t)(end - first),
        .start = (uint32_t)start,
        .samples = samples,
        .first_frame = first,
        .audio_bytes = u->pcm ? samples * 2 : 0,
        .audio = u->pcm ? (const uint8_t *)(u->pcm + cut->at) : NULL, /* little-endian: see meson.build */
    };
    cut->at += samples;
}

void segment_cut_enter(struct segment_cut *cut, const struct media_segment *segment) {
    const struct sentence_audio *u = segment->audio;
    *cut = (struct segment_cut){.at = segment->skip};
    while (cut->word < u->word_count && u->words[cut->word].start < cut->at)
        cut->word++;
    while (cut->mark < u->mark_count && u->marks[cut->mark].at < cut->at)
        cut->mark++;
    while (cut->phone < u->phone_count && u->phones[cut->phone].start < cut->at)
        cut->phone++;
}
