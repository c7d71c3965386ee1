/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/align.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

static double frame_of(uint64_t sample, uint32_t rate) {
    return (double)sample * FEATURE_RATE / rate / FEATURE_HOP;
}

/* The frame of the recording in the middle of what frame j of the reference is. */
static size_t nearest(const struct align_map *map, size_t j, size_t count) {
    size_t end = map->until[j] > map->at[j] ? map->until[j] - 1 : map->at[j], middle = (map->at[j] + end) / 2;
    return middle < count ? middle : count - 1;
}

/* Noise before a word costs the warp no more on a frame of the word than beside it, so the word may begin
 * with the noise: a frame so near to the word's boundary (frames) that is held for so long (frames of the
 * recording) is not the word but something that is none of it; so much is left to it. */
enum {
    NEAR_WORD = 8,
    BEGIN_HELD = 30,
    END_HELD = 60,
    HELD_KEPT = 4,
    CLOSURE = 12
}; /* last vowels are long */

static bool is_held(const struct align_map *map, size_t j, size_t least) {
    return map->until[j] > map->at[j] + least;
}

/* Frames of the reference from..to of which the last that is held is `held`: begin where its holding ends. */
static void begin_later(struct align_map *map, size_t from, size_t held) {
    size_t begin = map->until[held] - HELD_KEPT;
    for (size_t j = from; j <= held; j++)
        map->at[j] = begin;
    for (size_t j = from; j < held; j++)
        map->until[j] = begin;
}

static void end_sooner(struct align_map *map, size_t held, size_t to) {
    size_t end = map->at[held] + HELD_KEPT;
    for (size_t j = held; j < to; j++)
        map->until[j] = end;
    for (size_t j = held + 1; j < to; j++)
        map->at[j] = end;
}

/* A word that begins with a closed mouth may begin in the pause before it: with its first sounds spread over
 * a silence so long that it is none of the word. It begins where the last such silence ends. */
static void begin_after_silence(struct align_map *map, size_t from, size_t to,
                                const struct features *recording) {
    size_t silent = 0, begin = 0;
    for (size_t i = map->at[from]; i < map->until[to - 1] && i < recording->count; i++) {
        silent = recording->silent[i] ? silent + 1 : 0;
        if (silent > BEGIN_HELD)
            begin = i + 1 - HELD_KEPT;
    }
    for (size_t j = from; j < to && map->at[j] < begin; j++) {
        map->at[j] = begin;
        map->until[j] = map->until[j] > begin ? map->until[j] : begin;
    }
}

/* Gives back what words hold at their beginnings and before pauses that none of them is. */
static void release(struct align_map *map, const size_t *gaps, size_t count,
                    const struct features *recording) {
    for (size_t g = 0; g < count; g++) {
        size_t held = SIZE_MAX, end = g + 1 < count ? gaps[g + 1] : map->frames;
        size_t near = gaps[g] + CLOSURE < map->frames ? gaps[g] + CLOSURE : map->frames;
        if (near > gaps[g])
            begin_after_silence(map, gaps[g], near, recording);
        for (size_t j = gaps[g]; j < gaps[g] + NEAR_WORD && j < end; j++)
            if (is_held(map, j, BEGIN_HELD))
                held = j;
        if (held != SIZE_MAX)
            begin_later(map, gaps[g], held);
    }
    for (size_t g = 0; g <= count; g++) { /* what ends there */
        size_t to = g < count ? gaps[g] : map->frames, from = g ? gaps[g - 1] : 0;
        size_t first = to > from + NEAR_WORD ? to - NEAR_WORD : from;
        for (size_t j = first; j < to; j++)
            if (is_held(map, j, END_HELD)) {
                end_sooner(map, j, to);
                break;
            }
    }
}

int align_make(struct align_map *map, const struct align_sound *recording,
               const struct align_sound *reference, const struct align_options *how) {
    struct features a, b;
    *map = (struct align_map){.measured_speech_rate = recording->rate,
                              .reference_rate = reference->rate,
                              .measured_speech_samples = recording->samples};
    features_make(&a, recording->pcm, recording->samples, recording->rate);
    features_make(&b, reference->pcm, reference->samples, reference->rate);
    size_t *gaps = mem_alloc((how->start_count + 1) * sizeof *gaps), gap_count = 0;
    for (size_t i = 0; i < how->start_count; i++) {
        size_t frame = (size_t)lround(frame_of(how->starts[i], reference->rate));
        if (frame < b.count && (!gap_count || frame > gaps[gap_count - 1]))
            gaps[gap_count++] = frame;
    }
    struct warp_options options = {gaps, gap_count, how->stop, how->open_end};
    map->frames = b.count;
    map->at = mem_alloc((b.count + 1) * sizeof *map->at);
    map->until = mem_alloc(b.count * sizeof *map->until);
    map->apart = mem_alloc(b.count * sizeof *map->apart);
    map->passed = mem_alloc(b.count * sizeof *map->passed);
    map->distance = warp(&a, &b, &options, map->at, map->until);
    if (map->distance >= 0)
        release(map, gaps, gap_count, &a);
    for (size_t j = 0; j < b.count && map->distance >= 0; j++)
        map->apart[j] = b.silent[j] ? -1 : warp_distance(a.frames[nearest(map, j, a.count)], b.frames[j]);
    for (size_t j = 1; j < b.count && map->distance >= 0; j++)
        for (size_t i = map->until[j - 1]; i < map->at[j]; i++)
            map->passed[j] += !a.silent[i] && map->passed[j] < UINT16_MAX;
    features_free(&a);
    features_free(&b);
    free(gaps);
    return map->distance < 0 ? -1 : 0;
}

void align_free(struct align_map *map) {
    free(map->at);
    free(map->until);
    free(map->apart);
    free(map->passed);
    *map = (struct align_map){0};
}

static uint64_t sample_of(const struct align_map *map, double frame) {
    uint64_t time = (uint64_t)llround(frame * FEATURE_HOP / FEATURE_RATE * map->measured_speech_rate);
    return time < map->measured_speech_samples ? time : map->measured_speech_samples;
}

/* A moment of the reference that is so near, in frames, to a pause that only the recording has lies at it:
 * its frames are longer than they are apart. */
#define AT_PAUSE 1.6

/* The frame before such a pause, or map->frames. */
static size_t pause_near(const struct align_map *map, double frame) {
    size_t first = frame > AT_PAUSE ? (size_t)ceil(frame - AT_PAUSE) : 1, found = map->frames;
    for (size_t k = first; k < map->frames && (double)k <= frame + AT_PAUSE; k++)
        if (k && map->at[k] > map->until[k - 1] &&
            (found == map->frames || fabs((double)k - frame) < fabs((double)found + 1 - frame)))
            found = k - 1;
    return found;
}

static double inside(const struct align_map *map, double frame) {
    size_t j = frame < (double)map->frames ? (size_t)frame : map->frames - 1;
    return (double)map->at[j] + (frame - (double)j) * (double)(map->until[j] - map->at[j]);
}

uint64_t align_time(const struct align_map *map, uint64_t sample) {
    double frame = fmin(frame_of(sample, map->reference_rate), (double)map->frames);
    size_t pause = pause_near(map, frame);
    return sample_of(map, pause < map->frames ? (double)map->at[pause + 1] : inside(map, frame));
}

uint64_t align_end_time(const struct align_map *map, uint64_t sample) {
    double frame = fmin(frame_of(sample, map->reference_rate), (double)map->frames);
    size_t pause = pause_near(map, frame);
    return sample_of(map, pause < map->frames ? (double)map->until[pause] : inside(map, frame));
}

double align_apart(const struct align_map *map, uint64_t from, uint64_t to) {
    double sum = 0, count = 0, end = frame_of(to, map->reference_rate);
    for (size_t j = (size_t)frame_of(from, map->reference_rate); j < map->frames && (double)j < end; j++)
        if (map->apart[j] >= 0) {
            sum += map->apart[j];
            count++;
        }
    return count > 0 ? sum / count : -1;
}

double align_held(const struct align_map *map, uint64_t from, uint64_t to) {
    size_t most = 0;
    double end = frame_of(to, map->reference_rate);
    for (size_t j = (size_t)frame_of(from, map->reference_rate); j < map->frames && (double)j < end; j++)
        most = map->until[j] - map->at[j] > most ? map->until[j] - map->at[j] : most;
    return (double)most * FEATURE_HOP / FEATURE_RATE;
}

double align_passed(const struct align_map *map, uint64_t from, uint64_t to) {
    double frames = 0, end = frame_of(to, map->reference_rate);
    for (size_t j = (size_t)frame_of(from, map->reference_rate) + 1; j < map->frames && (double)j < end; j++)
        frames += map->passed[j];
    return frames * FEATURE_HOP / FEATURE_RATE;
}
