/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/align.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Costs of a step on top of the distance: staying on a frame of the reference, and skipping one or two.
 * Tuned on two Festival voices aligned to espeak-ng, male and female: median error 10 ms where the two are
 * alike. */
#define STAY_COST 1.5f
#define LEAP_COST 1.2f
/* Cost of a frame of a pause that the reference lacks: silent, or not. */
#define PAUSE_COST 0.15f
#define NOISE_COST 6.0f
/* Anything may be heard before the first word. The cost is lower than the mean distance of other sounds
 * from the words, and higher than that of the words themselves. */
#define BEFORE_COST 5.2f
#define LOUDNESS_WEIGHT 6.0f
#define SLOPE_WEIGHT 0.6f
/* Timbre has full weight from 1 / AUDIBLE of the loudness on and less below, as that of silence means
 * nothing. */
#define AUDIBLE 1.2f
#define FAR 1e30f
/* Paths that cost this much more than the best one up to the same frame are pruned: 2 s of other words. */
#define BEAM 500.0f

/* Where a path came from: that many reference frames back (at most LEAPS), or one of these. */
enum { FROM_GAP = 255, FROM_REFERENCE = 254, FROM_PAUSE = 253, LEAPS = 3 };

struct table {
    const struct features *a, *b; /* recording, reference */
    const struct warp_options *options;
    uint8_t *frame_from, *gap_from; /* for each recording frame: b->count and gap_count entries */
    float *now, *before, *gap_now, *gap_before;
    int *gap_of;         /* gap before each frame of the reference, or -1 */
    float limit, least;  /* pruning limit; least cost in this row so far */
    size_t *pause_start; /* for a frame after a pause: the first frame of the pause, else the frame itself */
};

float warp_distance(const float *x, const float *y) {
    float sum = 0, slopes = 0, loud = x[0] - y[0], audible = fmaxf(x[0], y[0]) * AUDIBLE;
    for (int c = 1; c < FEATURE_CEPSTRA; c++)
        sum += (x[c] - y[c]) * (x[c] - y[c]);
    for (int c = FEATURE_CEPSTRA; c < FEATURE_COUNT; c++)
        slopes += (x[c] - y[c]) * (x[c] - y[c]);
    sum += SLOPE_WEIGHT * slopes;
    return sqrtf(fminf(1, audible) * sum + LOUDNESS_WEIGHT * loud * loud * FEATURE_CEPSTRA);
}

static void table_open(struct table *t) {
    size_t n = t->b->count, gaps = t->options->gap_count;
    t->frame_from = mem_alloc(t->a->count * n);
    t->gap_from = mem_alloc(t->a->count * gaps + 1);
    t->now = mem_alloc(n * sizeof *t->now);
    t->before = mem_alloc(n * sizeof *t->before);
    t->gap_now = mem_alloc((gaps + 1) * sizeof *t->gap_now);
    t->gap_before = mem_alloc((gaps + 1) * sizeof *t->gap_before);
    t->gap_of = mem_alloc(n * sizeof *t->gap_of);
    t->pause_start = mem_alloc(n * sizeof *t->pause_start);
    for (size_t j = 0; j < n; j++) {
        t->gap_of[j] = -1;
        t->pause_start[j] = j;
        if (j && !t->b->silent[j])
            while (t->pause_start[j] && t->b->silent[t->pause_start[j] - 1])
                t->pause_start[j]--;
    }
    for (size_t g = 0; g < gaps; g++)
        if (t->options->gaps[g] < n)
            t->gap_of[t->options->gaps[g]] = (int)g;
}

static void table_close(struct table *t) {
    free(t->frame_from);
    free(t->gap_from);
    free(t->now);
    free(t->before);
    free(t->gap_now);
    free(t->gap_before);
    free(t->gap_of);
    free(t->pause_start);
}

static void consider(float *best, uint8_t *from, float cost, uint8_t way) {
    if (cost < *best) {
        *best = cost;
        *from = way;
    }
}

/* Enters the gap before word g from the frame before the word, or stays in it. */
static void step_gap(struct table *t, size_t i, size_t g) {
    size_t j = t->options->gaps[g];
    float best = FAR, pause = t->a->silent[i] ? PAUSE_COST : g ? NOISE_COST : BEFORE_COST;
    uint8_t from = FROM_GAP;
    if (i == 0) {
        best = j == 0 ? 0 : FAR;
    } else {
        consider(&best, &from, t->gap_before[g], FROM_GAP);
        if (j > 0)
            consider(&best, &from, t->before[j - 1], FROM_REFERENCE);
    }
    t->gap_now[g] = best + pause;
    if (g) /* waiting at the start must not prune other paths */
        t->least = fminf(t->least, t->gap_now[g]);
    t->gap_from[i * t->options->gap_count + g] = from;
}

static void step_frame(struct table *t, size_t i, size_t j) {
    float best = FAR;
    uint8_t from = 0;
    if (i == 0) {
        best = j == 0 ? 0 : FAR;
    } else {
        consider(&best, &from, t->before[j] + STAY_COST, 0);
        for (uint8_t back = 1; back <= LEAPS && back <= j; back++)
            consider(&best, &from, t->before[j - back] + (float)(back - 1) * LEAP_COST, back);
        if (t->gap_of[j] >= 0)
            consider(&best, &from, t->gap_before[t->gap_of[j]], FROM_GAP);
        if (t->pause_start[j] && t->pause_start[j] < j)
            consider(&best, &from, t->before[t->pause_start[j] - 1] + LEAP_COST, FROM_PAUSE);
    }
    t->now[j] = FAR;
    if (best < t->limit) {
        t->now[j] = best + warp_distance(t->a->frames[i], t->b->frames[j]);
        t->least = fminf(t->least, t->now[j]);
    }
    t->frame_from[i * t->b->count + j] = from;
}

/* Traces the path back: the recording's frames for each frame of the reference. */
static void trace(const struct table *t, size_t last, size_t *at, size_t *until) {
    size_t n = t->b->count, j = n - 1, gaps = t->options->gap_count;
    int gap = -1; /* current gap, -1 outside */
    at[n] = until[j] = last + 1;
    for (size_t i = last + 1; i-- > 0;) {
        uint8_t from = gap >= 0 ? t->gap_from[i * gaps + (size_t)gap] : t->frame_from[i * n + j];
        if (gap >= 0) {
            if (from == FROM_REFERENCE && i) {
                j = t->options->gaps[gap] - 1;
                until[j] = i;
                gap = -1;
            }
            continue;
        }
        at[j] = i;
        if (!i)
            break;
        if (from == FROM_GAP) {
            gap = t->gap_of[j];
        } else {
            size_t to = from == FROM_PAUSE ? t->pause_start[j] - 1 : j - from;
            for (size_t over = to + 1; over < j; over++)
                at[over] = until[over] = i; /* skipped */
            if (to != j)
                until[to] = i;
            j = to;
        }
    }
}

double warp(const struct features *recording, const struct features *reference,
            const struct warp_options *options, size_t *at, size_t *until) {
    struct table t = {.a = recording, .b = reference, .options = options};
    size_t n = reference->count, last = recording->count - 1;
    float best = FAR;
    if (recording->count * LEAPS < n)
        return -1;
    table_open(&t);
    for (size_t j = 0; j < n; j++)
        t.before[j] = FAR;
    for (size_t i = 0; i < recording->count; i++) {
        if (options->stop && atomic_load_explicit(options->stop, memory_order_relaxed)) {
            best = FAR;
            break;
        }
        t.limit = i ? t.least + BEAM : FAR;
        t.least = FAR;
        for (size_t g = 0; g < options->gap_count; g++)
            step_gap(&t, i, g);
        for (size_t j = 0; j < n; j++)
            step_frame(&t, i, j);
        /* cost per frame, so that an open end does not favour the earliest one */
        float end = t.now[n - 1] / (float)(i + 1);
        if (t.now[n - 1] < FAR && (options->open_end ? end <= best : i == recording->count - 1)) {
            best = end;
            last = i;
        }
        float *swap = t.now;
        t.now = t.before;
        t.before = swap;
        swap = t.gap_now;
        t.gap_now = t.gap_before;
        t.gap_before = swap;
    }
    memset(at, 0, (n + 1) * sizeof *at);
    memset(until, 0, n * sizeof *until);
    if (best < FAR)
        trace(&t, last, at, until);
    table_close(&t);
    return best < FAR ? best : -1;
}

static double frame_of(uint64_t sample, uint32_t rate) {
    return (double)sample * FEATURE_RATE / rate / FEATURE_HOP;
}

/* Frame of the recording in the middle of frame j of the reference. */
static size_t nearest(const struct align_map *map, size_t j, size_t count) {
    size_t end = map->until[j] > map->at[j] ? map->until[j] - 1 : map->at[j], middle = (map->at[j] + end) / 2;
    return middle < count ? middle : count - 1;
}

/* Noise before a word costs as much on a frame of the word as beside it, so the word may seem to begin
 * with the noise. A frame near the word's boundary (in frames) that is held this long (frames of the
 * recording) is such noise; the last constant is what the word keeps of it. */
enum {
    NEAR_WORD = 8,
    BEGIN_HELD = 30,
    END_HELD = 60,
    HELD_KEPT = 4,
    CLOSURE = 12
}; /* final vowels are long */

static bool is_held(const struct align_map *map, size_t j, size_t least) {
    return map->until[j] > map->at[j] + least;
}

/* Starts the frames from..to where the last held one, `held`, ends. */
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

/* A word that begins with a closed mouth may begin in the pause before it, with its first sounds spread
 * over a long silence. Makes it begin after the last such silence. */
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

/* Takes noise and silence away from the starts of words and from before pauses. */
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
    for (size_t g = 0; g <= count; g++) { /* the word that ends at the gap */
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
    *map = (struct align_map){.measured_speech_rate = recording->rate,
                              .reference_rate = reference->rate,
                              .measured_speech_samples = recording->samples};
    features_make(&map->recording, recording->pcm, recording->samples, recording->rate);
    features_make(&map->reference, reference->pcm, reference->samples, reference->rate);
    const struct features a = map->recording, b = map->reference;
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
    free(gaps);
    return map->distance < 0 ? -1 : 0;
}

void align_free(struct align_map *map) {
    free(map->at);
    free(map->until);
    free(map->apart);
    free(map->passed);
    features_free(&map->recording);
    features_free(&map->reference);
    *map = (struct align_map){0};
}

static uint64_t sample_of(const struct align_map *map, double frame) {
    uint64_t time = (uint64_t)llround(frame * FEATURE_HOP / FEATURE_RATE * map->measured_speech_rate);
    return time < map->measured_speech_samples ? time : map->measured_speech_samples;
}

/* A moment of the reference this close, in frames, to a pause of the recording is taken to be at it, since
 * frames are longer than their distance. */
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

size_t align_frame(uint64_t sample, uint32_t rate) {
    return (size_t)frame_of(sample, rate);
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

/* Reversing the order makes other words only if there are enough of them. */
enum { WORDS_LEAST = 4 };
#define SECONDS 10.0
/* Searches the length of the words in the recording, times this. */
#define MORE 1.3

double chance(const struct align_sound *recording, const struct reference_speech *speech,
              const struct align_map *map, const atomic_bool *stop, double *apart) {
    size_t count = 0;
    while (count < speech->word_count && (double)speech->words[count].start < SECONDS * speech->rate)
        count++;
    if (count < WORDS_LEAST)
        return -1;
    size_t end = count < speech->word_count ? speech->words[count].start : speech->samples, used = 0;
    int16_t *pcm = mem_alloc(end * sizeof *pcm);
    uint64_t *starts = mem_alloc(count * sizeof *starts);
    size_t to = end;
    for (size_t i = count; i-- > 0; to = speech->words[i].start) {
        size_t from = speech->words[i].start, length = from < to ? to - from : 0;
        starts[count - 1 - i] = used;
        memcpy(pcm + used, speech->pcm + from, length * sizeof *pcm);
        used += length;
    }
    struct align_sound part = *recording, reversed = {pcm, used, speech->rate};
    size_t long_enough = (size_t)((double)align_end_time(map, end) * MORE);
    if (long_enough < part.samples)
        part.samples = long_enough;
    const struct align_options options = {starts, count, true, stop};
    struct align_map other;
    double result = align_make(&other, &part, &reversed, &options) ? -1 : align_apart(&other, 0, used);
    *apart = align_apart(map, 0, end);
    align_free(&other);
    free(starts);
    free(pcm);
    return result;
}
