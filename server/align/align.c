/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/align.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

static double frame_of(uint64_t sample, uint32_t rate) {
    return (double)sample * FEATURE_RATE / rate / FEATURE_HOP;
}

int align_make(struct align_map *map, const struct align_sound *recording,
               const struct align_sound *reference, const uint64_t *words, size_t word_count, bool open_end) {
    struct features a, b;
    *map = (struct align_map){.recording_rate = recording->rate,
                              .reference_rate = reference->rate,
                              .recording_samples = recording->samples};
    features_make(&a, recording->pcm, recording->samples, recording->rate);
    features_make(&b, reference->pcm, reference->samples, reference->rate);
    size_t *gaps = mem_alloc((word_count + 1) * sizeof *gaps), gap_count = 0;
    for (size_t i = 0; i < word_count; i++) {
        size_t frame = (size_t)lround(frame_of(words[i], reference->rate));
        if (frame < b.count && (!gap_count || frame > gaps[gap_count - 1]))
            gaps[gap_count++] = frame;
    }
    struct warp_options options = {gaps, gap_count, open_end};
    map->frames = b.count;
    map->at = mem_alloc((b.count + 1) * sizeof *map->at);
    map->distance = warp(&a, &b, &options, map->at);
    features_free(&a);
    features_free(&b);
    free(gaps);
    return map->distance < 0 ? -1 : 0;
}

void align_free(struct align_map *map) {
    free(map->at);
    *map = (struct align_map){0};
}

uint64_t align_time(const struct align_map *map, uint64_t sample) {
    double frame = frame_of(sample, map->reference_rate);
    if (frame >= (double)map->frames)
        frame = (double)map->frames;
    size_t j = (size_t)frame < map->frames ? (size_t)frame : map->frames - 1;
    double at = (double)map->at[j] + (frame - (double)j) * (double)(map->at[j + 1] - map->at[j]);
    uint64_t time = (uint64_t)llround(at * FEATURE_HOP / FEATURE_RATE * map->recording_rate);
    return time < map->recording_samples ? time : map->recording_samples;
}
