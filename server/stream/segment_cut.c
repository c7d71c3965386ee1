/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/segment_cut.h"

void segment_cut_media(struct segment_cut *cut, const struct media_segment *segment,
                       struct face_placement *face, double fps, uint32_t samples, struct media *media) {
    const struct sentence_audio *u = segment->audio;
    if (samples > u->samples - cut->at)
        samples = u->samples - cut->at;
    uint64_t start = (uint64_t)(segment->start + cut->at);
    uint32_t first = frame_from_sample(start, u->sample_rate, fps);
    uint32_t end = frame_from_sample(start + samples, u->sample_rate, fps);
    for (uint32_t k = first; k < end; k++)
        media_segment_frame(segment, face, fps, k, &media->frames[k - first]);
    *media = (struct media){.sample_rate = u->sample_rate,
                            .fps = fps,
                            .start = (uint32_t)start,
                            .samples = samples,
                            .pcm = u->pcm ? u->pcm + cut->at : NULL,
                            .first_frame = first,
                            .frame_count = end - first,
                            .frames = media->frames};
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
