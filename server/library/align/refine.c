/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/refine.h"
#include "server/base/mem.h"
#include "server/library/align/sound_classes.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Parts of a phone: beginning, middle, end. */
enum { PARTS = SOUND_CLASS_PARTS };
/* Frames (8 ms) by which a boundary may move, of the longest usual phone, and of the longest one that the
 * warp may find; how often the speaker's phones are learnt. */
enum { REACH = 75, LONGEST = 64, LONGEST_EVER = 192, ROUNDS = 2 };
/* The constants were chosen on the development persons of tests/bench/align-truth.mjs. */
/* Frames that the synthetic voice's mean counts for, and share that earlier stretches keep. */
#define PRIOR 30.0
#define KEPT 0.7
/* Weight of a frame's likelihood by the speaker's phones, with and without the recogniser's classes, and by
 * these: neighbouring frames say much the same. */
#define WEIGHT 0.1
#define WEIGHT_ALONE 0.15
#define CLASS_WEIGHT 0.5
/* Spread of the logarithm of durations, relative to the reference's at the speaker's rate. */
#define SPREAD 0.3
/* Log probabilities of a pause before a word, and where the reference pauses, of one and of none. */
#define PAUSE (-4.0)
#define USUAL_PAUSE (-0.3)
#define NO_PAUSE (-1.5)
/* Least scores of a frame in a pause, which may be noise or a breath. */
#define NOISE (-22.0)
#define CLASS_NOISE (-4.0)
/* Exponent of all probabilities when a place is doubted: they come from frames that are no witnesses of their
 * own. Frames within which a start counts as found: 0.1 s. */
#define DOUBT 0.25
#define NEAR 12.5
/* Log probability of a sound that the recogniser does not know. */
#define UNHEARD (-1.0F)
#define NEVER (-1e30)
/* Silence is learnt from this many frames on. */
#define QUIET_LEAST 5

struct type {
    char ipa[PHONE_NAME_BYTES];
    int classes[PARTS];                                /* enum lip_class; -1 = unknown */
    double sum[PARTS][FEATURE_COUNT], count[PARTS];    /* of the recording */
    double prior[PARTS][FEATURE_COUNT], priors[PARTS]; /* of the reference, this stretch */
    float mean[PARTS][FEATURE_COUNT];
};

struct refine_model {
    struct type *types;
    size_t count, cap;
};

/* The boundary before a phone, or after the last one: frames from..from + size - 1. */
struct boundary {
    size_t from, size, at; /* at: of the logs */
};

struct refining {
    struct refine_model *model;
    const struct features *recording;
    struct refine_phone *phones;
    size_t count, frames;
    size_t *type_of;
    struct boundary *boundaries; /* count + 1 */
    double *ended, *begun;       /* forward: log probability that the phone before ended, the phone began */
    double *after, *rest; /* backward: of all that follows once the phone before ended, the phone began */
    double *quiet;        /* running sum of a pause's scores, from frame 0 */
    const struct sound_likelihoods *heard; /* may be NULL */
    double (*parts)[PARTS];                /* running sums of the current phone's scores */
    size_t parts_from;
    double *logs, *ways; /* logarithms of lengths in frames; of the ways to come to a frame */
    float precision[FEATURE_COUNT], mean_quiet[FEATURE_COUNT];
    double pace;   /* frames of the recording per frame of the reference */
    double weight; /* of the speaker's phones */
    double sharp;  /* exponent of all probabilities: less than 1 leaves more doubt */
};

struct refine_model *refine_model_new(void) {
    return mem_alloc(sizeof(struct refine_model));
}

void refine_model_free(struct refine_model *model) {
    if (model)
        free(model->types);
    free(model);
}

static size_t type_find(struct refine_model *m, const char *ipa) {
    for (size_t i = 0; i < m->count; i++)
        if (!strcmp(m->types[i].ipa, ipa))
            return i;
    m->types = mem_grow(m->types, &m->cap, m->count + 1, sizeof *m->types);
    m->types[m->count] = (struct type){.count = {0}};
    snprintf(m->types[m->count].ipa, sizeof m->types[m->count].ipa, "%s", ipa);
    sound_classes_of(ipa, m->types[m->count].classes);
    return m->count++;
}

static void add(double sum[FEATURE_COUNT], const float *frame) {
    for (int c = 0; c < FEATURE_COUNT; c++)
        sum[c] += frame[c];
}

static size_t part_of(size_t from, size_t to, size_t frame) {
    return (frame - from) * PARTS / (to - from);
}

/* The reference's phones are what is known at first. */
static void learn_reference(struct refining *r, const struct features *reference) {
    struct refine_model *m = r->model;
    for (size_t i = 0; i < m->count; i++) {
        memset(m->types[i].prior, 0, sizeof m->types[i].prior);
        memset(m->types[i].priors, 0, sizeof m->types[i].priors);
    }
    for (size_t j = 0; j < r->count; j++) {
        const struct refine_phone *p = &r->phones[j];
        struct type *t = &m->types[r->type_of[j]];
        for (size_t k = p->from; k < p->to && k < reference->count; k++) {
            size_t part = part_of(p->from, p->to, k);
            add(t->prior[part], reference->frames[k]);
            t->priors[part]++;
        }
    }
}

static void set_means(struct refine_model *m) {
    for (size_t i = 0; i < m->count; i++)
        for (size_t s = 0; s < PARTS; s++) {
            struct type *t = &m->types[i];
            double prior = t->priors[s] > 0 ? PRIOR / t->priors[s] : 0;
            double all = t->count[s] + prior * t->priors[s] + 1e-9;
            for (int c = 0; c < FEATURE_COUNT; c++)
                t->mean[s][c] = (float)((t->sum[s][c] + prior * t->prior[s][c]) / all);
        }
}

static void forget(struct refine_model *m, double share) {
    for (size_t i = 0; i < m->count; i++)
        for (size_t s = 0; s < PARTS; s++) {
            m->types[i].count[s] *= share;
            for (int c = 0; c < FEATURE_COUNT; c++)
                m->types[i].sum[s][c] *= share;
        }
}

/* Adds the recording's frames where the phones are now, or takes them away (sign -1). */
static void learn(struct refining *r, double sign) {
    for (size_t j = 0; j < r->count; j++) {
        const struct refine_phone *p = &r->phones[j];
        struct type *t = &r->model->types[r->type_of[j]];
        size_t from = (size_t)lround(p->begins), to = (size_t)lround(p->ends);
        for (size_t k = from; k < to && k < r->frames; k++) {
            size_t part = part_of(from, to, k);
            for (int c = 0; c < FEATURE_COUNT; c++)
                t->sum[part][c] += sign * r->recording->frames[k][c];
            t->count[part] += sign;
        }
    }
}

/* Spread around the means, and the mean of silence. */
static void measure(struct refining *r) {
    double square[FEATURE_COUNT] = {0}, n = 1e-9, quiet[FEATURE_COUNT] = {0}, quiets = 1e-9;
    for (size_t j = 0; j < r->count; j++) {
        const struct refine_phone *p = &r->phones[j];
        const struct type *t = &r->model->types[r->type_of[j]];
        size_t from = (size_t)lround(p->begins), to = (size_t)lround(p->ends);
        for (size_t k = from; k < to && k < r->frames; k++, n++)
            for (int c = 0; c < FEATURE_COUNT; c++) {
                double x = r->recording->frames[k][c] - t->mean[part_of(from, to, k)][c];
                square[c] += x * x;
            }
    }
    for (size_t k = 0; k < r->frames; k++)
        if (r->recording->silent[k]) {
            add(quiet, r->recording->frames[k]);
            quiets++;
        }
    for (int c = 0; c < FEATURE_COUNT; c++) {
        r->precision[c] = (float)(0.5 / fmax(square[c] / n, 1e-5));
        r->mean_quiet[c] = (float)(quiet[c] / quiets);
    }
    if (quiets < QUIET_LEAST)
        r->mean_quiet[0] = -10; /* never */
}

static double score(const struct refining *r, const float *mean, size_t frame) {
    const float *x = r->recording->frames[frame];
    float sum = 0;
    for (int c = 0; c < FEATURE_COUNT; c++)
        sum += (x[c] - mean[c]) * (x[c] - mean[c]) * r->precision[c];
    return -r->weight * r->sharp * (double)sum;
}

static double class_score(const struct refining *r, int class, size_t frame) {
    return r->heard && class >= 0 ? CLASS_WEIGHT * r->sharp * (double)r->heard[frame].log[class] : 0;
}

/* Smaller terms of a sum of probabilities are left out: their logs are this much less than the largest. */
#define NEGLIGIBLE 12.0

/* Logarithm of the sum of two probabilities given by their logarithms; of many. */
static double both(double a, double b) {
    double most = fmax(a, b), least = fmin(a, b);
    return least > most - NEGLIGIBLE ? most + (double)log1pf(expf((float)(least - most))) : most;
}

static double sum_up(const double *logs, size_t count) {
    double most = NEVER;
    float sum = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, logs[i]);
    for (size_t i = 0; i < count && most > NEVER; i++)
        sum += logs[i] > most - NEGLIGIBLE ? expf((float)(logs[i] - most)) : 0;
    return most > NEVER ? most + (double)logf(sum) : NEVER;
}

/* Running sums of a phone's parts over the frames that it may cover. */
static void prepare(struct refining *r, size_t j) {
    const struct type *t = &r->model->types[r->type_of[j]];
    size_t from = r->boundaries[j].from, to = r->boundaries[j + 1].from + r->boundaries[j + 1].size;
    double sums[PARTS] = {0};
    r->parts_from = from;
    for (size_t k = from; k < to; k++)
        for (size_t s = 0; s < PARTS; s++) {
            r->parts[k - from][s] = sums[s];
            sums[s] += k < r->frames ? score(r, t->mean[s], k) + class_score(r, t->classes[s], k) : 0;
        }
}

/* Log probability that the prepared phone, of that usual length (its logarithm), is the frames from..to. */
static double segment(const struct refining *r, size_t from, size_t to, double usual) {
    size_t length = to - from, first = from + length / PARTS, second = from + 2 * length / PARTS;
    const double(*sums)[PARTS] = r->parts;
    double stretch = (r->logs[length] - usual) / SPREAD;
    from -= r->parts_from;
    first -= r->parts_from;
    second -= r->parts_from;
    to -= r->parts_from;
    return sums[first][0] - sums[from][0] + sums[second][1] - sums[first][1] + sums[to][2] - sums[second][2] -
           0.5 * r->sharp * stretch * stretch;
}

static double usual_length(const struct refining *r, size_t j) {
    return log(fmax(1, (double)(r->phones[j].to - r->phones[j].from) * r->pace));
}

static size_t longest(const struct refining *r, size_t j) {
    size_t now = (r->phones[j].end - r->phones[j].start) * 3 / 2;
    return now < LONGEST ? LONGEST : now < LONGEST_EVER ? now : LONGEST_EVER;
}

/* Whether a pause may precede phone j, and the log probabilities of one and of none. */
static bool pauses(const struct refining *r, size_t j, double *some, double *none) {
    bool may = j == 0 || j == r->count || r->phones[j].word || r->phones[j].pause;
    bool likely = j == 0 || j == r->count || r->phones[j].pause;
    *some = r->sharp * (likely ? USUAL_PAUSE : PAUSE);
    *none = likely ? r->sharp * NO_PAUSE : 0;
    return may;
}

static void forward(struct refining *r) {
    for (size_t j = 0; j <= r->count; j++) {
        const struct boundary *b = &r->boundaries[j];
        double *ended = r->ended + b->at, *begun = r->begun + b->at, some, none, pause = NEVER;
        for (size_t i = 0; i < b->size; i++)
            ended[i] = j == 0 && i == 0 ? 0 : NEVER;
        if (j) {
            const struct boundary *a = &r->boundaries[j - 1];
            const double *before = r->begun + a->at, usual = usual_length(r, j - 1);
            size_t most = longest(r, j - 1);
            prepare(r, j - 1);
            for (size_t i = 0; i < b->size; i++) {
                size_t to = b->from + i, k = to > a->from + most ? to - a->from - most : 0, ways = 0;
                for (; k < a->size && a->from + k < to; k++)
                    if (before[k] > NEVER / 2)
                        r->ways[ways++] = before[k] + segment(r, a->from + k, to, usual);
                ended[i] = sum_up(r->ways, ways);
            }
        }
        bool may = pauses(r, j, &some, &none);
        for (size_t i = 0; i < b->size; i++) {
            begun[i] = may ? both(ended[i] + none, pause) : ended[i];
            double quiet = r->quiet[b->from + i + 1] - r->quiet[b->from + i];
            pause = may ? both(pause, ended[i] + some) + quiet : NEVER;
        }
    }
}

static void backward(struct refining *r) {
    for (size_t j = r->count + 1; j-- > 0;) {
        const struct boundary *b = &r->boundaries[j];
        double *after = r->after + b->at, *rest = r->rest + b->at, some, none, pause = NEVER;
        for (size_t i = 0; i < b->size; i++)
            rest[i] = j == r->count && i == b->size - 1 ? 0 : NEVER;
        if (j < r->count) {
            const struct boundary *a = &r->boundaries[j + 1];
            const double *next = r->after + a->at, usual = usual_length(r, j);
            size_t most = longest(r, j);
            prepare(r, j);
            for (size_t i = 0; i < b->size; i++) {
                size_t from = b->from + i, k = from >= a->from ? from + 1 - a->from : 0, ways = 0;
                for (; k < a->size && a->from + k <= from + most; k++)
                    if (next[k] > NEVER / 2)
                        r->ways[ways++] = next[k] + segment(r, from, a->from + k, usual);
                rest[i] = sum_up(r->ways, ways);
            }
        }
        bool may = pauses(r, j, &some, &none);
        for (size_t i = b->size; i-- > 0;) {
            after[i] = may ? both(rest[i] + none, pause + some) : rest[i];
            double quiet = i ? r->quiet[b->from + i] - r->quiet[b->from + i - 1] : 0;
            pause = may ? both(pause, rest[i]) + quiet : NEVER;
        }
    }
}

static double probability(const double *a, const double *b, size_t i, double all) {
    return exp(a[i] + b[i] - all);
}

static double sum_of(const double *a, const double *b, size_t size) {
    double all = NEVER;
    for (size_t i = 0; i < size; i++)
        all = both(all, a[i] + b[i]);
    return all;
}

/* Median of a boundary's place, in frames, by logs of its probabilities. */
static double median(const double *a, const double *b, const struct boundary *at) {
    double all = sum_of(a, b, at->size), half = 0;
    for (size_t i = 0; i < at->size; i++) {
        double p = probability(a, b, i, all);
        if (half + p >= 0.5)
            return (double)at->from + (double)i + (0.5 - half) / p - 0.5;
        half += p;
    }
    return (double)(at->from + at->size - 1);
}

/* Probability that the boundary is near that place. */
static double near(const double *a, const double *b, const struct boundary *at, double place) {
    double all = sum_of(a, b, at->size), sum = 0;
    for (size_t i = 0; i < at->size; i++)
        if (fabs((double)(at->from + i) - place) <= NEAR)
            sum += probability(a, b, i, all);
    return fmin(1, sum);
}

/* Scores of pauses, for each frame. */
static void prepare_pauses(struct refining *r) {
    double noise = r->sharp * r->weight * NOISE, other = r->sharp * CLASS_WEIGHT * CLASS_NOISE;
    for (size_t k = 0; k <= r->frames; k++) {
        double sound = k < r->frames ? fmax(score(r, r->mean_quiet, k), noise) : 0;
        double class = k < r->frames ? fmax(class_score(r, LIP_SILENCE, k), other) : 0;
        r->quiet[k + 1] = r->quiet[k] + sound + class;
    }
}

static bool search(struct refining *r) {
    prepare_pauses(r);
    forward(r);
    backward(r);
    const struct boundary *last = &r->boundaries[r->count];
    double all = NEVER;
    for (size_t i = 0; i < last->size; i++)
        all = both(all, r->ended[last->at + i] + r->after[last->at + i]);
    return all > NEVER / 2;
}

static void place(struct refining *r) {
    for (size_t j = 0; j < r->count; j++) {
        const struct boundary *b = &r->boundaries[j], *e = b + 1;
        struct refine_phone *p = &r->phones[j];
        p->begins = fmax(median(r->begun + b->at, r->rest + b->at, b), j ? p[-1].ends : 0);
        p->ends = fmax(median(r->ended + e->at, r->after + e->at, e), p->begins);
    }
}

static void doubt(struct refining *r) {
    for (size_t j = 0; j < r->count; j++) {
        const struct boundary *b = &r->boundaries[j];
        r->phones[j].sure = (float)near(r->begun + b->at, r->rest + b->at, b, r->phones[j].begins);
    }
}

/* How well each phone's class is heard where the phone lies. */
static void listen(struct refining *r) {
    for (size_t j = 0; j < r->count; j++) {
        struct refine_phone *p = &r->phones[j];
        const int *classes = r->model->types[r->type_of[j]].classes;
        size_t from = (size_t)lround(p->begins), to = (size_t)lround(p->ends), frames = 0;
        double sum = 0;
        for (size_t k = from; r->heard && k < to && k < r->frames; k++)
            if (classes[part_of(from, to, k)] >= 0) {
                sum += (double)r->heard[k].log[classes[part_of(from, to, k)]];
                frames++;
            }
        p->heard = frames ? (float)fmin(0, sum / (double)frames) : UNHEARD;
    }
}

/* Where the warp has put the boundary before phone j. A phone that it holds for too long may be anywhere in
 * there. */
static void reach(const struct refining *r, size_t j, size_t *early, size_t *late) {
    const struct refine_phone *next = j < r->count ? &r->phones[j] : NULL,
                              *last = j ? &r->phones[j - 1] : NULL;
    *early = last ? last->end : next->start;
    *late = next ? next->start : last->end;
    if (last && last->end > last->start + LONGEST)
        *early = last->start;
    if (next && next->end > next->start + LONGEST)
        *late = next->end;
}

static void refining_open(struct refining *r) {
    size_t used = 0, widest = 0, most = LONGEST;
    double spoken = 0, took = 0;
    for (size_t j = 0; j < r->count; j++) {
        struct refine_phone *p = &r->phones[j];
        p->end = p->end < r->frames ? p->end : r->frames;
        p->start = p->start < p->end ? p->start : p->end;
    }
    for (size_t j = 0; j <= r->count; j++) {
        size_t early, late;
        reach(r, j, &early, &late);
        struct boundary *b = &r->boundaries[j];
        size_t to = late + REACH < r->frames ? late + REACH : r->frames;
        b->from = early > REACH ? early - REACH : 0;
        b->size = to - b->from + 1;
        b->at = used;
        used += b->size;
        if (j && to - b[-1].from > widest)
            widest = to - b[-1].from;
        if (j && longest(r, j - 1) > most)
            most = longest(r, j - 1);
    }
    r->ended = mem_alloc(used * sizeof *r->ended);
    r->begun = mem_alloc(used * sizeof *r->begun);
    r->after = mem_alloc(used * sizeof *r->after);
    r->rest = mem_alloc(used * sizeof *r->rest);
    r->ways = mem_alloc((most + 2) * sizeof *r->ways);
    r->logs = mem_alloc((most + 2) * sizeof *r->logs);
    for (size_t i = 0; i < most + 2; i++)
        r->logs[i] = log((double)i);
    r->parts = mem_alloc((widest + 2) * sizeof *r->parts);
    r->quiet = mem_alloc((r->frames + 2) * sizeof *r->quiet);
    r->type_of = mem_alloc(r->count * sizeof *r->type_of);
    for (size_t j = 0; j < r->count; j++) {
        struct refine_phone *p = &r->phones[j];
        p->begins = (double)p->start;
        p->ends = (double)p->end;
        r->type_of[j] = type_find(r->model, p->ipa);
        spoken += (double)(p->to - p->from);
        took += (double)(p->end - p->start);
    }
    r->pace = spoken > 0 && took > 0 ? took / spoken : 1;
}

static void refining_close(struct refining *r) {
    free(r->boundaries);
    free(r->ended);
    free(r->begun);
    free(r->after);
    free(r->rest);
    free(r->parts);
    free(r->logs);
    free(r->ways);
    free(r->quiet);
    free(r->type_of);
}

bool refine(struct refine_model *model, const struct features *recording, const struct features *reference,
            const struct sound_likelihoods *heard, struct refine_phone *phones, size_t count,
            const atomic_bool *stop) {
    struct refining r = {.heard = heard,
                         .model = model,
                         .recording = recording,
                         .phones = phones,
                         .count = count,
                         .frames = recording->count,
                         .sharp = 1,
                         .weight = heard ? WEIGHT : WEIGHT_ALONE};
    bool good = count;
    if (!count)
        return false;
    r.boundaries = mem_alloc((count + 1) * sizeof *r.boundaries);
    refining_open(&r);
    forget(model, KEPT);
    learn_reference(&r, reference);
    for (int i = 0; i < ROUNDS && good; i++) {
        learn(&r, 1);
        set_means(model);
        measure(&r);
        learn(&r, -1);
        good = !(stop && atomic_load_explicit(stop, memory_order_relaxed)) && search(&r);
        if (good)
            place(&r);
    }
    r.sharp = DOUBT;
    good = good && search(&r);
    if (good) {
        doubt(&r);
        learn(&r, 1);
        listen(&r);
    }
    refining_close(&r);
    return good;
}
