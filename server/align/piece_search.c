/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/piece_search.h"
#include "server/align/warp.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One frame in so many counts, of those that are not silent: pauses say nothing. */
enum { STEP = 3, LEAPS = 3, SLACK = 12 };
/* As in warp.c, which is where fine alignment is made. */
#define STAY_COST 1.5f
#define LEAP_COST 1.2f
#define FAR 1e30f
/* What is not of the text costs this share of what other words would: measured. */
#define OTHER_SHARE 0.955f
/* To go on elsewhere, and to leave a piece out. */
#define JUMP_COST 14.0f
#define SKIP_COST 4.0f
/* Other words are the pieces' own in another order: stretches of so many frames, backwards; so many frames of
 * them are enough. */
enum { STRETCH = 10, OTHER_FRAMES = 500 };

struct grid {
    float (*frames)[FEATURE_COUNT];
    size_t *from; /* frames of the features */
    size_t count;
};

/* What is known at a frame when some pieces are decided. */
struct node {
    float ended, adjacent, between; /* a piece ends here, or within SLACK; anything else is heard */
    uint32_t start, end;            /* of the piece that ended; where the adjacent one did */
    bool jumped;                    /* the piece that ended did not follow another */
    uint8_t way;                    /* into between */
};
enum { STAYED, FROM_END, SKIPPED };

struct search {
    const atomic_bool *stop;
    struct grid a, b;
    float other;     /* cost of a frame that is not of the text, in the mean */
    float *other_at; /* the same for each frame of the recording */
    float *now, *before;
    uint32_t *start_now, *start_before; /* where a way began, with the highest bit: by a jump */
};
#define JUMPED (1u << 31)

/* A frame in every `step`. */
static void grid_make(struct grid *g, const struct features *f, size_t from, size_t to, double step) {
    size_t i = from;
    for (size_t k = 0; i < to && i < f->count; i = from + (size_t)((double)++k * step))
        if (!f->silent[i]) {
            memcpy(g->frames[g->count], f->frames[i], sizeof g->frames[0]);
            g->from[g->count++] = i;
        }
}

static void grid_open(struct grid *g, size_t frames, size_t more) {
    g->frames = mem_alloc((frames / STEP + more + 1) * sizeof *g->frames);
    g->from = mem_alloc((frames / STEP + more + 1) * sizeof *g->from);
}

static void grid_close(struct grid *g) {
    free(g->frames);
    free(g->from);
}

static void better(float cost, uint32_t start, float *best, uint32_t *from) {
    if (cost < *best) {
        *best = cost;
        *from = start;
    }
}

/* One frame of the recording against the frames from..to of the reference; enter is what it costs to begin
 * here. */
static void step(struct search *s, size_t i, size_t from, size_t to, float enter, uint32_t start) {
    size_t m = to - from;
    for (size_t j = 0; j < m; j++) {
        float best = s->before[j] + STAY_COST;
        uint32_t way = s->start_before[j];
        for (size_t back = 1; back <= LEAPS; back++) {
            float leap = (float)(back - 1) * LEAP_COST;
            if (back <= j)
                better(s->before[j - back] + leap, s->start_before[j - back], &best, &way);
            else if (back == j + 1)
                better(enter + leap, start, &best, &way);
        }
        s->start_now[j] = way;
        s->now[j] = best < FAR / 2
                        ? best + warp_distance(s->a.frames[i], s->b.frames[from + j]) - s->other_at[i]
                        : FAR;
    }
}

static void swap(struct search *s) {
    float *costs = s->now;
    uint32_t *starts = s->start_now;
    s->now = s->before;
    s->before = costs;
    s->start_now = s->start_before;
    s->start_before = starts;
}

static void begin(struct search *s, size_t m) {
    for (size_t j = 0; j < m; j++)
        s->before[j] = FAR;
}

static bool stopped(const struct search *s) {
    return s->stop && atomic_load_explicit(s->stop, memory_order_relaxed);
}

/* One piece: nodes before it and after it, of every frame. */
static void search_piece(struct search *s, size_t from, size_t to, const struct node *before,
                         struct node *after) {
    size_t n = s->a.count, m = to - from;
    begin(s, m);
    for (size_t i = 0; i <= n; i++) {
        struct node *here = &after[i];
        bool jump = before[i].between < before[i].adjacent;
        *here = (struct node){
            .ended = FAR, .adjacent = FAR, .between = before[i].between + SKIP_COST, .way = SKIPPED};
        if (i && m) {
            here->ended = s->before[m - 1];
            here->start = s->start_before[m - 1] & ~JUMPED;
            here->jumped = (s->start_before[m - 1] & JUMPED) != 0;
        }
        for (size_t back = 0; back <= SLACK && back <= i; back++)
            if (after[i - back].ended < here->adjacent) {
                here->adjacent = after[i - back].ended;
                here->end = (uint32_t)(i - back);
            }
        if (here->ended + JUMP_COST < here->between) {
            here->between = here->ended + JUMP_COST;
            here->way = FROM_END;
        }
        if (i && after[i - 1].between <= here->between) {
            here->between = after[i - 1].between;
            here->way = STAYED;
        }
        if (i < n) {
            step(s, i, from, to, jump ? before[i].between : before[i].adjacent,
                 (uint32_t)i | (jump ? JUMPED : 0));
            swap(s);
        }
    }
}

/* What a frame of other words costs in the mean, where they come nearest. */
static float other_words(struct search *s, size_t m) {
    float(*words)[FEATURE_COUNT] = s->b.frames;
    size_t used = m < OTHER_FRAMES ? m : OTHER_FRAMES, n = s->a.count;
    if (!used || !n)
        return 0;
    float(*backwards)[FEATURE_COUNT] = mem_alloc(used * sizeof *backwards);
    for (size_t j = 0; j < used; j++) {
        size_t stretch = j / STRETCH * STRETCH, length = used - stretch < STRETCH ? used - stretch : STRETCH;
        memcpy(backwards[used - stretch - length + (j - stretch)], words[j], sizeof *backwards);
    }
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += warp_distance(s->a.frames[i], backwards[i * 7919 % used]);
    s->b.frames = backwards;
    s->other = (float)(sum / (double)n) * 0.9f;
    for (size_t i = 0; i < n; i++)
        s->other_at[i] = s->other;
    double distance = 0, length = 0;
    for (size_t from = 0; from < used; from += 4 * STRETCH * STRETCH / 2) {
        size_t to = from + 2 * STRETCH * STRETCH < used ? from + 2 * STRETCH * STRETCH : used;
        float best = FAR;
        size_t begun = 0, ended = 1;
        begin(s, to - from);
        for (size_t i = 0; i < n && !stopped(s); i++) {
            step(s, i, from, to, 0, (uint32_t)i);
            if (s->now[to - from - 1] < best) {
                best = s->now[to - from - 1];
                begun = s->start_now[to - from - 1];
                ended = i + 1;
            }
            swap(s);
        }
        if (best < FAR / 2) {
            distance += (double)best + (double)s->other * (double)(ended - begun);
            length += (double)(ended - begun);
        }
    }
    s->b.frames = words;
    free(backwards);
    return length > 0 ? (float)(distance / length) : s->other;
}

/* Noise and music, which hardly change, are nearer to all words than words are to each other: what is not of
 * the text costs less there, by how far the frames thereabouts are from the text's in the mean. */
static void judge_frames(struct search *s) {
    enum { SAMPLES = 64, ABOUT = 15 };
    size_t n = s->a.count, m = s->b.count;
    double *sums = mem_alloc((n + 1) * sizeof *sums);
    for (size_t i = 0; i < n; i++) {
        double sum = 0;
        for (size_t k = 0; k < SAMPLES && m; k++)
            sum += warp_distance(s->a.frames[i], s->b.frames[(i + k * m / SAMPLES) % m]);
        sums[i + 1] = sums[i] + sum;
    }
    for (size_t i = 0; i < n; i++) {
        size_t from = i > ABOUT ? i - ABOUT : 0, to = i + ABOUT < n ? i + ABOUT : n;
        double here = (sums[to] - sums[from]) / (double)(to - from), all = sums[n] / (double)n;
        s->other_at[i] = s->other * (float)(all > 0 ? fmin(1, here / all) : 1);
    }
    free(sums);
}

/* From the last frame back: which pieces were found, and where. */
static void trace(const struct search *s, struct node *const *nodes, size_t count,
                  struct piece_place *places) {
    size_t i = s->a.count;
    bool between = nodes[count][i].between <= nodes[count][i].adjacent;
    for (size_t k = count; k > 0;) {
        const struct node *here = &nodes[k][i];
        if (between && here->way == STAYED && i) {
            i--;
            continue;
        }
        if (between && here->way == SKIPPED) {
            k--;
            continue;
        }
        size_t end = between ? i : here->end;
        const struct node *last = &nodes[k][end];
        const struct node *first = &nodes[k - 1][last->start];
        between = last->jumped;
        float gain = (between ? first->between : first->adjacent) - last->ended;
        places[k - 1] =
            (struct piece_place){.found = true,
                                 .follows = !last->jumped,
                                 .begin = s->a.from[last->start],
                                 .end = s->a.from[end - 1] + STEP,
                                 .gain = gain,
                                 .apart = OTHER_SHARE * (1 - gain / (float)(end - last->start) / s->other)};
        i = last->start;
        k--;
    }
}

int piece_search(const struct piece_search *how, struct piece_place *places) {
    struct search s = {.stop = how->stop};
    size_t *bounds = mem_alloc((how->count + 1) * sizeof *bounds), longest = 2 * STRETCH * STRETCH;
    struct node **nodes = mem_alloc((how->count + 1) * sizeof *nodes);
    memset(places, 0, how->count * sizeof *places);
    grid_open(&s.a, how->recording->count, 0);
    double step = fmax(1, STEP / fmax(1, how->pace)); /* as many frames as the recording has of it */
    grid_open(&s.b, STEP * how->reference->count, how->count);
    grid_make(&s.a, how->recording, 0, how->recording->count, STEP);
    for (size_t k = 0; k < how->count; k++) {
        grid_make(&s.b, how->reference, how->pieces[k].from, how->pieces[k].to, step);
        bounds[k + 1] = s.b.count;
        longest = bounds[k + 1] - bounds[k] > longest ? bounds[k + 1] - bounds[k] : longest;
    }
    s.now = mem_alloc(longest * sizeof *s.now);
    s.before = mem_alloc(longest * sizeof *s.before);
    s.start_now = mem_alloc(longest * sizeof *s.start_now);
    s.start_before = mem_alloc(longest * sizeof *s.start_before);
    s.other_at = mem_alloc((s.a.count + 1) * sizeof *s.other_at);
    s.other = other_words(&s, s.b.count) * OTHER_SHARE;
    judge_frames(&s);
    for (size_t k = 0; k <= how->count; k++)
        nodes[k] = mem_alloc((s.a.count + 1) * sizeof **nodes);
    for (size_t i = 0; i <= s.a.count; i++)
        nodes[0][i] = (struct node){.ended = FAR, .adjacent = i <= SLACK ? 0 : FAR, .between = JUMP_COST};
    for (size_t k = 0; k < how->count && !stopped(&s); k++)
        search_piece(&s, bounds[k], bounds[k + 1], nodes[k], nodes[k + 1]);
    if (!stopped(&s) && s.a.count)
        trace(&s, nodes, how->count, places);
    for (size_t k = 0; k <= how->count; k++)
        free(nodes[k]);
    free(nodes);
    free(bounds);
    free(s.other_at);
    free(s.now);
    free(s.before);
    free(s.start_now);
    free(s.start_before);
    grid_close(&s.a);
    grid_close(&s.b);
    return stopped(&s) ? -1 : 0;
}
