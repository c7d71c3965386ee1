/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/long_alignment.h"
#include "server/base/mem.h"
#include "server/library/align/align.h"
#include "server/library/align/long_alignment_internal.h"
#include "server/library/align/mfcc.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- piece search: which pieces of a text a stretch of a recording contains, and where. Pieces may be
 * missing, and anything may be between them. A Viterbi search (A. Viterbi, IEEE Trans. Information Theory
 * 13, 1967) on a coarse grid, with a state for other sound ---- */

struct piece_place {
    bool found;
    bool follows;      /* the previous piece precedes it directly, or with a breath between */
    size_t begin, end; /* frames of the recording */
    float gain;        /* accumulated advantage over other sound */
    float apart;       /* mean distance, as a share of that of other words */
};

struct piece_frames {
    size_t from, to; /* frames of the reference */
};

struct piece_search {
    const struct features *recording, *reference;
    const struct piece_frames *pieces; /* in text order */
    size_t count;
    double pace; /* frames of the recording per frame of the reference, 1 to 3: how much slower it is read */
    const atomic_bool *stop; /* becomes true to cancel; may be NULL */
};

/* Uses every STEP-th frame that is not silent; pauses carry no information. */
enum { STEP = 3, LEAPS = 3, SLACK = 12 };
/* As in align.c, which refines the result. */
#define STAY_COST 1.5f
#define LEAP_COST 1.2f
#define FAR 1e30f
/* Cost of other sound, as a share of that of other words: measured. */
#define OTHER_SHARE 0.955f
/* Cost of continuing elsewhere, and of leaving out a piece. */
#define JUMP_COST 14.0f
#define SKIP_COST 4.0f
/* Other words are the pieces themselves in another order: stretches of STRETCH frames, reversed.
 * OTHER_FRAMES frames of them suffice. */
enum { STRETCH = 10, OTHER_FRAMES = 500 };

struct grid {
    float (*frames)[FEATURE_COUNT];
    size_t *from; /* grid frame to feature frame */
    size_t count;
};

/* State at a frame when some pieces are decided. */
struct node {
    float ended, adjacent, between; /* a piece ends here; ended within SLACK; other sound */
    uint32_t start, end;            /* of the piece that ended; end of the adjacent one */
    bool jumped;                    /* the piece that ended did not follow another directly */
    uint8_t way;                    /* how `between` was entered */
};
enum { STAYED, FROM_END, SKIPPED };

struct search {
    const atomic_bool *stop;
    struct grid a, b;
    float other;     /* mean cost of a frame of other sound */
    float *other_at; /* the same for each frame of the recording */
    float *now, *before;
    uint32_t *start_now, *start_before; /* start of each path; the top bit marks a jump */
};
#define JUMPED (1u << 31)

/* Takes every `step`-th frame. */
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

/* Advances by one frame of the recording over frames from..to of the reference; `enter` is the cost of
 * starting here. */
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

/* Processes one piece: computes the nodes after it from those before it, for every frame. */
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

/* Mean cost of a frame of other words, where they come closest. */
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

/* Noise and music barely change and are close to all words. There other sound costs less, by how far the
 * surrounding frames are from the text on average. */
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

/* Traces back from the last frame: the pieces found, and their places. */
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

/* Fills places[count] in text order. -1 on cancellation. Needs count * recording->count bytes, and time
 * proportional to the product of both lengths. */
static int piece_search(const struct piece_search *how, struct piece_place *places) {
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

/* ---- recovery where text and recording differ ---- */

/* Searches this much text at once, by sentences, in the sound that it would take plus some seconds; then
 * in what follows, overlapping, a limited number of times. */
static const struct speak_amount block_amount = {40, 14};
#define AHEAD_SECONDS 60.0
#define OVERLAP_SECONDS 25.0
enum { LOOKS = 8 };
#define PACE_FIRST 1.2
/* Reading paces to try: a much slower reader is not found at the voice's pace. */
static const double paces[] = {1, 1.35, 1.8};
/* Consecutive pieces are trusted if together they gain this much over other sound. */
#define TRUST 25.0f
/* Seconds on both sides of a found piece that are aligned with it. */
#define MARGIN 0.3
/* A piece that ends this close to the end of the searched sound may be cut off. */
#define CUT_SECONDS 1.0
/* Bytes of the text to try before anything has been found. */
enum { TRIED_BYTES = 2500 };

/* A block of text, and what was found of it. */
struct block {
    struct spoken said;
    struct window window;
    struct piece_place places[PIECES_MAX];
    size_t last; /* last piece that counts; said.count = none */
    double gain;
    const char *voice;
};

static size_t sample_of(const struct block *b, size_t frame) {
    size_t sample = (size_t)((double)frame * FEATURE_HOP / FEATURE_RATE * b->window.source->rate);
    return sample < b->window.samples ? sample : b->window.samples;
}

/* Keeps only runs of pieces that are trusted together and not cut off by the window's end. */
static void judge(struct block *b) {
    size_t end = b->said.count, cut = b->window.samples - (size_t)(CUT_SECONDS * b->window.source->rate);
    b->last = end;
    b->gain = 0;
    for (size_t k = 0; k < end;) {
        float gain = 0;
        size_t to = k;
        do
            gain += b->places[to].gain;
        while (++to < end && b->places[to].found && b->places[to].follows);
        for (size_t i = k; i < to; i++)
            b->places[i].found = b->places[i].found && gain >= TRUST;
        if (gain >= TRUST) {
            b->last = to - 1;
            b->gain += (double)gain;
        }
        k = to;
    }
    if (b->last < end && !b->window.ended && sample_of(b, b->places[b->last].end) > cut) {
        b->places[b->last].found = false;
        do
            b->last = b->last ? b->last - 1 : end;
        while (b->last < end && !b->places[b->last].found);
    }
}

static int search(const struct long_alignment *c, struct block *b) {
    struct features recording, reference;
    struct piece_frames frames[PIECES_MAX];
    struct piece_place places[PIECES_MAX];
    size_t which[PIECES_MAX], count = 0;
    const struct reference_speech *s = &b->said.speech;
    features_make(&recording, b->window.pcm, b->window.samples, b->window.source->rate);
    features_make(&reference, s->pcm, s->samples, s->rate);
    for (size_t k = 0; k < b->said.count; k++) {
        const struct reference_span *span = &b->said.spans[k];
        b->places[k] = (struct piece_place){.found = false};
        if (span[1].words == span->words)
            continue;
        which[count] = k;
        frames[count++] =
            (struct piece_frames){(size_t)((double)span->start * FEATURE_RATE / s->rate / FEATURE_HOP),
                                  (size_t)((double)span->end * FEATURE_RATE / s->rate / FEATURE_HOP)};
    }
    int result = 0;
    bool all = false;
    for (size_t p = 0; p < sizeof paces / sizeof *paces && !result && !all; p++) {
        struct piece_search how = {&recording, &reference, frames, count, paces[p], c->stop};
        struct block best = *b; /* result of the previous paces */
        result = piece_search(&how, places);
        for (size_t i = 0; i < count; i++)
            b->places[which[i]] = places[i];
        judge(b);
        all = true;
        for (size_t i = 0; i < count; i++)
            all = all && b->places[which[i]].found;
        if (p && best.gain >= b->gain) {
            memcpy(b->places, best.places, sizeof b->places);
            b->last = best.last;
            b->gain = best.gain;
        }
    }
    features_free(&recording);
    features_free(&reference);
    return result;
}

/* Searches for a block spoken by one voice, further and further on. -1 with *e; otherwise the result is in
 * b. */
static int look(struct long_alignment *c, struct block *b, struct error *e) {
    double rate = c->window.source->rate, pace = c->pace > 0 ? c->pace : PACE_FIRST;
    b->window = window_copy(&c->window);
    b->last = b->said.count;
    if (long_alignment_speak(c, &b->said, b->voice, &block_amount, e))
        return -1;
    double seconds = (double)b->said.speech.samples / (b->said.speech.rate ? b->said.speech.rate : 1);
    for (int i = 0; i < LOOKS; i++) {
        window_fill(&b->window, (size_t)((seconds * pace + AHEAD_SECONDS) * rate));
        if (search(c, b))
            return long_alignment_cancelled(e);
        if (b->last < b->said.count || b->window.ended)
            return 0;
        window_drop(&b->window, b->window.samples - (size_t)(OVERLAP_SECONDS * rate));
    }
    return 0;
}

/* True when everything up to that byte is there, from the start of the window. */
static bool whole(const struct block *b, size_t until) {
    bool first = true;
    for (size_t k = 0; k < b->said.count && b->said.spans[k].to <= until; k++) {
        if (b->said.spans[k + 1].words == b->said.spans[k].words)
            continue;
        if (!b->places[k].found || !b->places[k].follows)
            return false;
        first = false;
    }
    return !first;
}

/* Aligns the consecutive pieces from..to precisely. */
static void take_run(struct long_alignment *c, struct block *b, size_t from, size_t to) {
    const struct reference_speech *s = &b->said.speech;
    const struct reference_span *spans = b->said.spans;
    size_t margin = (size_t)(MARGIN * b->window.source->rate), count, used = 0;
    size_t begin = sample_of(b, b->places[from].begin), end = sample_of(b, b->places[to - 1].end) + margin;
    begin = begin > margin ? begin - margin : 0;
    end = end < b->window.samples ? end : b->window.samples;
    uint64_t *starts = long_alignment_pauses(s, &count), first = spans[from].start;
    for (size_t i = 0; i < count; i++)
        if (starts[i] >= first && starts[i] < spans[to - 1].end)
            starts[used++] = starts[i] - first;
    const struct align_sound recording = {b->window.pcm + begin, end - begin, b->window.source->rate};
    const struct align_sound reference = {s->pcm + first, (size_t)(spans[to - 1].end - first), s->rate};
    const struct align_options options = {starts, used, true, c->stop};
    struct align_map map;
    bool well = !align_make(&map, &recording, &reference, &options);
    struct fit fit = {.map = &map, .window = &b->window, .said = &b->said, .from = first, .base = begin};
    if (well)
        long_alignment_refine(c, &fit, &spans[from], &spans[to]);
    double until = c->until;
    size_t first_ready = c->ready_count;
    for (size_t k = from; k < to; k++)
        if (well)
            long_alignment_take(c, &fit, &spans[k], (double)b->places[k].apart);
        else
            long_alignment_miss(c, &spans[k]);
    struct long_alignment_piece *piece = &c->ready[first_ready];
    double rate = b->window.source->rate;
    if (well && piece->start > until)
        piece->passed = window_sounds(&b->window, (uint64_t)(until * rate), (uint64_t)(piece->start * rate),
                                      piece->start - until);
    align_free(&map);
    free(fit.phones);
    free(starts);
}

static void take_block(struct long_alignment *c, struct block *b) {
    for (size_t k = 0, to; k <= b->last; k = to) {
        to = k + 1;
        if (!b->places[k].found) {
            if (b->said.spans[to].words > b->said.spans[k].words)
                long_alignment_miss(c, &b->said.spans[k]);
            continue;
        }
        while (to <= b->last && b->places[to].found && b->places[to].follows)
            to++;
        take_run(c, b, k, to);
    }
    size_t end = sample_of(b, b->places[b->last].end);
    c->at = b->said.spans[b->last + 1].from;
    c->chosen = b->voice;
    c->lost = false;
    window_close(&c->window);
    c->window = b->window;
    b->window = (struct window){0};
    window_drop(&c->window, end);
}

/* Skips half of the block, or the rest of the text, as nothing of it was found. */
static int pass_over(struct long_alignment *c, const struct block *b, struct error *e) {
    size_t count = b->said.spans[b->said.count].from == c->size ? b->said.count : (b->said.count + 1) / 2;
    c->lost = true;
    for (size_t k = 0; k < count; k++)
        if (b->said.spans[k + 1].words > b->said.spans[k].words)
            long_alignment_miss(c, &b->said.spans[k]);
    c->at = b->said.spans[count].from;
    if (c->found || (c->at < TRIED_BYTES && c->at < c->size))
        return 1;
    double here = (double)window_place(&c->window, 0) / c->window.source->rate;
    long_alignment_misfit(c, 0, here, "the words are not those of the recording", &c->failure);
    c->failed = true;
    *e = c->failure;
    return -1;
}

/* Searches a stretch of text and sound for their common parts. 1: the results are ready, and the window is
 * past them. 0: the text up to that byte is there, without gaps. -1 with *e. */
static int long_alignment_recover(struct long_alignment *c, size_t until, struct error *e) {
    struct block *best = NULL;
    int result = 0;
    for (size_t i = 0; i < c->voice_count && !result; i++) {
        struct block *b = mem_alloc(sizeof *b);
        b->voice = c->found ? c->chosen : c->voices[i];
        result = look(c, b, e);
        bool better =
            !best || (b->last < b->said.count && (best->last == best->said.count || b->gain > best->gain));
        struct block *worse = better ? best : b;
        best = better ? b : best;
        if (worse) {
            window_close(&worse->window);
            reference_free(&worse->said.speech);
            free(worse);
        }
        if (c->found)
            break;
    }
    if (!result && best->last == best->said.count) {
        result = pass_over(c, best, e);
    } else if (!result && !(best->voice == c->chosen && whole(best, until))) {
        take_block(c, best);
        result = 1;
    }
    window_close(&best->window);
    reference_free(&best->said.speech);
    free(best);
    return result;
}

#define REST_ENOUGH 60.0
/* Signs that a window differs from the text: a piece is too distant (as a share of other words), takes
 * much less or more time than the others, or has seconds of other sound in it. */
#define PIECE_SHARE 0.975
#define SHORT_SHARE 0.6
#define LONG_SHARE 1.75
#define PASSED_SECONDS 0.6
#define JUDGED_SECONDS 1.0

void long_alignment_piece_free(struct long_alignment_piece *piece) {
    free(piece->phones);
    free(piece->words);
    *piece = (struct long_alignment_piece){0};
}

struct long_alignment *long_alignment_open(const struct sound_source *source, struct reference *reference,
                                           const char *text, size_t size,
                                           const struct long_alignment_options *options, struct error *e) {
    static const char *const genders[] = {"male", "female"};
    struct long_alignment *c = mem_alloc(sizeof *c);
    c->reference = reference;
    c->text = text;
    c->size = size;
    c->stop = options->stop;
    c->made = options->made;
    c->certain = options->certain;
    c->model = refine_model_new();
    for (int pass = 0; pass < 2 && !c->voice_count; pass++) /* a gender without a voice: any */
        for (int i = 0; i < 2; i++) {
            const char *voice = reference_voice(reference, options->lang, genders[i]);
            if (*voice && (pass || !options->gender || !strcmp(options->gender, genders[i]) ||
                           !strcmp(options->gender, "neutral")))
                c->voices[c->voice_count++] = voice;
        }
    window_open(&c->window, source);
    if (c->voice_count)
        return c;
    error_set(e, ERROR_NO_REFERENCE, "no voice to align with speaks '%.40s'", options->lang);
    long_alignment_free(c);
    return NULL;
}

void long_alignment_free(struct long_alignment *c) {
    if (!c)
        return;
    for (; c->ready_at < c->ready_count; c->ready_at++)
        long_alignment_piece_free(&c->ready[c->ready_at]);
    free(c->ready);
    window_close(&c->window);
    reference_free(&c->said.speech);
    refine_model_free(c->model);
    free(c);
}

/* What the recogniser hears decides about pieces of at least so many phones: said, or other words. */
enum { JUDGED_PHONES = 6 };
#define SAID (-1.9)
#define UNSAID (-2.4)

/* 1: each of the pieces is heard where it lies; -1: one is not; 0: undecided. */
static int heard(const struct fit *fit, const struct reference_span *spans, size_t count) {
    int result = 1;
    for (size_t i = 0; i < count && fit->heard; i++) {
        double here = long_alignment_heard(fit, spans[i].start, spans[i].end);
        if (spans[i + 1].phones < spans[i].phones + JUDGED_PHONES || here < SAID)
            result = result < 0 || here < UNSAID ? -1 : 0;
    }
    return fit->heard ? result : 0;
}

/* True when the pieces seem to be what is read. */
static bool fits(struct long_alignment *c, const struct fit *fit, size_t count) {
    const struct align_map *map = fit->map;
    const struct align_sound recording = {c->window.pcm, map->measured_speech_samples,
                                          c->window.source->rate};
    const struct reference_span *spans = c->said.spans;
    int said = heard(fit, spans, count);
    double apart, other = chance(&recording, &c->said.speech, map, c->stop, &apart);
    c->likely = said > 0 || other <= 0 || apart < CHANCE_SHARE * other;
    if (!c->likely && !c->certain)
        return false;
    if (other > 0)
        c->other = other;
    if (c->certain)
        return true;
    if (said < 0)
        return false;
    double all = (double)(align_end_time(map, spans[count - 1].end) - align_time(map, 0)) /
                 (double)spans[count - 1].end;
    for (size_t i = 0; i < count; i++) {
        double spoken = (double)(spans[i].end - spans[i].start);
        double took = (double)(align_end_time(map, spans[i].end) - align_time(map, spans[i].start));
        if (spoken < JUDGED_SECONDS * c->said.speech.rate)
            continue;
        bool odd = took < SHORT_SHARE * all * spoken || took > LONG_SHARE * all * spoken ||
                   (c->other > 0 && align_apart(map, spans[i].start, spans[i].end) > PIECE_SHARE * c->other);
        if ((odd && said <= 0) ||
            align_passed(map, spans[i ? i - 1 : 0].start, spans[i].end) > PASSED_SECONDS)
            return false;
    }
    return true;
}

static void take_all(struct long_alignment *c, const struct fit *fit, size_t count) {
    const struct align_map *map = fit->map;
    const struct reference_span *spans = c->said.spans;
    uint64_t begin = align_time(map, 0), end = align_end_time(map, spans[count - 1].end);
    for (size_t i = 0; i < count; i++) {
        double apart = align_apart(map, spans[i].start, spans[i].end);
        long_alignment_take(c, fit, &spans[i], c->other > 0 && apart >= 0 ? apart / c->other : 0);
    }
    if (end > begin)
        c->pace = (double)(end - begin) / c->window.source->rate /
                  ((double)spans[count - 1].end / c->said.speech.rate);
    window_drop(&c->window, (size_t)end);
    c->at = spans[count].from;
}

/* Aligns the next pieces if they follow directly: 1; 0: they seem not to; -1 with *e. */
static int follow(struct long_alignment *c, struct error *e) {
    struct align_map map;
    bool begins = !c->at && !c->pace;
    if ((!c->chosen && long_alignment_choose_voice(c, e)) ||
        long_alignment_speak(c, &c->said, c->chosen, &long_alignment_window, e) ||
        (begins && c->said.speech.word_count && long_alignment_choose_start(c, e)))
        return -1;
    size_t count = c->said.count, to = c->said.spans[count].from;
    if (!c->said.speech.word_count) { /* nothing to speak in it */
        c->at = to;
        return 1;
    }
    count -= to < c->size; /* the last one may continue beyond the window */
    int result = long_alignment_find(c, &map) ? 0 : 1;
    struct fit fit = {.map = &map, .window = &c->window, .said = &c->said};
    if (result)
        long_alignment_refine(c, &fit, c->said.spans, &c->said.spans[c->said.count]);
    if (result && !c->made && !fits(c, &fit, count)) {
        refine_model_free(c->model); /* it has learnt from wrong places */
        c->model = refine_model_new();
        result = long_alignment_stopped(c) ? 0 : long_alignment_recover(c, c->said.spans[count].from, e);
        if ((c->failed || (c->lost && result > 0)) && c->likely) {
            /* the whole is too short or too slowly spoken to be distinguished */
            c->failed = c->lost = false;
            c->at = c->said.spans[0].from;
            c->ready_count = 0;
            result = 0;
        }
        if (result) { /* it continued, or failed */
            free(fit.phones);
            align_free(&map);
            return result;
        }
        result = 1;
    }
    if (long_alignment_stopped(c))
        result = long_alignment_cancelled(e);
    if (result > 0)
        take_all(c, &fit, count);
    free(fit.phones);
    align_free(&map);
    return result;
}

static int advance(struct long_alignment *c, struct error *e) {
    double here = (double)window_place(&c->window, 0) / c->window.source->rate;
    if (c->failed) {
        *e = c->failure;
        return -1;
    }
    c->ready_at = c->ready_count = 0;
    int result = c->lost ? 0 : follow(c, e);
    if (result)
        return result < 0 ? -1 : 0;
    if (c->made)
        return long_alignment_misfit(c, c->at, here, "the recording ends before the text", e);
    return long_alignment_recover(c, 0, e) < 0 ? -1 : 0;
}

int long_alignment_next(struct long_alignment *c, struct long_alignment_piece *piece, struct error *e) {
    while (c->ready_at == c->ready_count) {
        if (c->at == c->size)
            return 0;
        if (advance(c, e))
            return -1;
    }
    *piece = c->ready[c->ready_at];
    c->ready[c->ready_at++] = (struct long_alignment_piece){0};
    return 1;
}

double long_alignment_rest(struct long_alignment *c) {
    return window_sounds(&c->window, window_place(&c->window, 0), UINT64_MAX, REST_ENOUGH);
}
