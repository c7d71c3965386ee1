/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/warp.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Tuned on two Festival voices aligned to espeak-ng, male and female: median error 10 ms where the two are
 * alike. What a step costs beside the distance: to stay on a frame of the reference, and to leap over one or
 * two. */
#define STAY_COST 1.5f
#define LEAP_COST 1.2f
/* A frame of a pause that the reference does not have: silent, or not. */
#define PAUSE_COST 0.15f
#define NOISE_COST 6.0f
/* What is heard before the first word may be anything: less than other sounds are from the words on average,
 * more than the words themselves. */
#define BEFORE_COST 5.2f
#define LOUDNESS_WEIGHT 6.0f
#define SLOPE_WEIGHT 0.6f
/* Timbre counts in full from 1 / AUDIBLE of the loudness on, less below: that of silence says nothing. */
#define AUDIBLE 1.2f
#define FAR 1e30f
/* Ways that have cost so much more than the best one up to the same frame are given up: 2 s of other words.
 */
#define BEAM 500.0f

/* The way into a cell: from how many frames of the reference back, or out of the gap before it. */
enum { FROM_GAP = 255, FROM_REFERENCE = 254, FROM_PAUSE = 253, LEAPS = 3 };

struct table {
    const struct features *a, *b; /* recording, reference */
    const struct warp_options *options;
    uint8_t *frame_from, *gap_from; /* of recording frame i: b->count, gap_count entries */
    float *now, *before, *gap_now, *gap_before;
    int *gap_of;         /* of each frame of the reference, or -1 */
    float limit, least;  /* of what is worth going on with; of this row so far */
    size_t *pause_start; /* of a frame that follows a pause: the pause's first frame, else its own number */
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

/* The gap before word g: from the frame before the word, or longer in the gap. */
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
    if (g) /* to wait at the beginning is no way that others have to keep up with */
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

/* From the end back: the frames of the recording on each frame of the reference. */
static void trace(const struct table *t, size_t last, size_t *at, size_t *until) {
    size_t n = t->b->count, j = n - 1, gaps = t->options->gap_count;
    int gap = -1; /* in the gap before that word */
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
                at[over] = until[over] = i; /* leapt over */
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
        /* cost per frame, so that an open end is not always the earliest */
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
