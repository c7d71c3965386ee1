/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life/life_blink.h"
#include "server/base/mem.h"
#include "server/face/life/life_eyes.h"
#include "server/face/life/life_prosody.h"
#include "server/face/life/life_random.h"
#include <stdlib.h>

/* Intervals between blinks: log-normal (Bentivoglio et al. 1997). */
#define INTERVAL_MEDIAN 2.9
#define INTERVAL_DEVIATION 0.65
#define INTERVAL_SHORTEST 0.6

/* Of the durations, whose medians are those of life_eyes.h. */
#define DURATION_DEVIATION 0.2
#define SLOWEST 1.8
#define FASTEST 0.6

/* Incomplete blinks (M. Doughty, Optom. Vis. Sci. 79, 2002) and double ones: probabilities. */
#define INCOMPLETE 0.12
#define SHALLOWEST 0.5
#define TWICE 0.06
#define TWICE_AFTER 0.38
#define LAG 0.002

/* Blinks with gaze shifts: the larger, the surer (C. Evinger et al., Exp. Brain Res. 100, 1994). */
#define EVOKED_FROM 8.0
#define EVOKED_SURE 33.0

/* In speech: how far, s, a blink is moved to the end of a phrase and how well it hits it; what is kept of
 * those that are too far; probability of an added one at the end of a phrase, and within it each so many
 * seconds. */
#define MOVE_MOST 0.7
#define PAUSE_SCATTER 0.07
#define KEPT 0.8
#define AT_PAUSE 0.6
#define AT_PAUSE_PER_SECOND 0.35
#define ADDED 0.22
#define ADDED_EACH 1.5

void blinks_free(struct blinks *blinks) {
    free(blinks->items);
    *blinks = (struct blinks){0};
}

static struct blink *add(struct blinks *blinks, struct dice *d, double at) {
    blinks->items = mem_grow(blinks->items, &blinks->cap, blinks->count + 1, sizeof *blinks->items);
    struct blink *b = &blinks->items[blinks->count++];
    double slow = exp(DURATION_DEVIATION * dice_normal(d));
    *b = (struct blink){.at = at,
                        .closing = (float)(BLINK_CLOSING * slow),
                        .closed = (float)(BLINK_CLOSED * slow),
                        .opening = (float)(BLINK_OPENING * slow * dice_between(d, 0.8, 1.2)),
                        .depth = 1,
                        .lag = (float)(LAG * dice_normal(d))};
    double roll = dice_roll(d);
    b->mark = (float)dice_roll(d);
    if (roll < INCOMPLETE)
        b->depth = (float)(SHALLOWEST + (0.95 - SHALLOWEST) * roll / INCOMPLETE);
    return b;
}

static int by_time(const void *a, const void *b) {
    double x = ((const struct blink *)a)->at, y = ((const struct blink *)b)->at;
    return x < y ? -1 : x > y;
}

/* Puts the blinks from index `first` on in order and drops those that come too soon after another. */
static void tidy(struct blinks *blinks, size_t first) {
    if (blinks->count <= first)
        return;
    qsort(blinks->items + first, blinks->count - first, sizeof *blinks->items, by_time);
    size_t kept = first;
    for (size_t i = first; i < blinks->count; i++) {
        const struct blink *b = &blinks->items[i], *last = kept > first ? &blinks->items[kept - 1] : NULL;
        double gap = b->twin ? TWICE_AFTER * 0.9 : INTERVAL_SHORTEST;
        if (!last || b->at - last->at >= gap)
            blinks->items[kept++] = *b;
    }
    blinks->count = kept;
}

void blinks_of_block(struct blinks *blinks, uint64_t seed, int64_t block, const struct shifts *glances) {
    struct dice d = dice_of(seed, DICE_BLINKS, block);
    double from = life_edge(seed, block), end = life_edge(seed, block + 1) - BLINK_LONGEST, last = from;
    size_t first = blinks->count;
    /* the first interval has been running for a while */
    double at = from + dice_roll(&d) * dice_log_normal(&d, INTERVAL_MEDIAN, INTERVAL_DEVIATION);
    while (at < end) {
        float mark = add(blinks, &d, at)->mark;
        if (dice_roll(&d) < TWICE && at + TWICE_AFTER < end) {
            struct blink *twin = add(blinks, &d, at + TWICE_AFTER);
            twin->twin = true;
            twin->mark = mark; /* comes and goes with the first one */
        }
        double spare = dice_between(&d, last, at); /* some blink more than others */
        if (at - last > 2 * INTERVAL_SHORTEST)
            add(blinks, &d, life_clip(spare, last + INTERVAL_SHORTEST, at - INTERVAL_SHORTEST))->mark += 1;
        last = at;
        at += fmax(INTERVAL_SHORTEST, dice_log_normal(&d, INTERVAL_MEDIAN, INTERVAL_DEVIATION));
    }
    for (size_t i = 1; i < glances->count; i++) {
        const struct shift *s = &glances->items[i];
        double way = hypot((double)(s->to[GAZE_YAW] - s[-1].to[GAZE_YAW]),
                           (double)(s->to[GAZE_PITCH] - s[-1].to[GAZE_PITCH]));
        bool here = s->at > from && s->at < end;
        if (here && way > EVOKED_FROM && dice_roll(&d) < (way - EVOKED_FROM) / (EVOKED_SURE - EVOKED_FROM))
            add(blinks, &d, s->at - 0.02);
    }
    tidy(blinks, first);
}

/* The phrase that ends nearest to t on the sentence's clock, seen from the one found before. */
static size_t nearest_end(const struct prosody *p, size_t from, double t) {
    while (from + 1 < p->phrase_count && fabs(p->phrases[from + 1].to - t) <= fabs(p->phrases[from].to - t))
        from++;
    return from;
}

/* When it is over, however slow it is made. */
static double over(const struct blink *b) {
    return b->at + SLOWEST * (double)(b->closing + b->closed + b->opening) + fabs((double)b->lag);
}

static void keep(struct blinks *blinks, const struct blink *b) {
    blinks->items = mem_grow(blinks->items, &blinks->cap, blinks->count + 1, sizeof *b);
    blinks->items[blinks->count++] = *b;
}

/* Adds one within from..to, with all that is to be seen of it; later ones are put back. */
static void add_within(struct blinks *blinks, struct dice *d, double at, double from, double to) {
    struct blink *b = add(blinks, d, at);
    b->at -= fmax(0, over(b) - to);
    if (b->at < from)
        blinks->count--;
}

static void add_some(struct blinks *blinks, struct dice *d, const struct phrase *phrase, double begin,
                     double from, double to) {
    double roll = dice_roll(d), end = begin + phrase->to;
    if (roll < fmin(AT_PAUSE, AT_PAUSE_PER_SECOND * (phrase->to - phrase->from)))
        add_within(blinks, d, end + PAUSE_SCATTER * dice_normal(d), from, to);
    for (double at = begin + phrase->from; at + ADDED_EACH < end; at += ADDED_EACH) {
        double wait = ADDED_EACH * dice_roll(d);
        if (dice_roll(d) < ADDED)
            add_within(blinks, d, at + wait, from, to);
    }
}

void blinks_of_speech(struct blinks *blinks, uint64_t seed, const struct prosody *p, double from, double to) {
    double begin = from + INTERVAL_SHORTEST;
    struct dice d = dice_of(seed, DICE_PLAN, ~p->name);
    struct blinks merged = {0};
    size_t i = 0, phrase = 0;
    if (!p->phrase_count)
        return;
    for (; i < blinks->count && blinks->items[i].at < begin; i++)
        keep(&merged, &blinks->items[i]);
    size_t first = merged.count;
    for (; i < blinks->count && over(&blinks->items[i]) < to; i++) {
        struct blink b = blinks->items[i];
        phrase = nearest_end(p, phrase, b.at - from);
        double pause = from + p->phrases[phrase].to + PAUSE_SCATTER * dice_normal(&d), roll = dice_roll(&d);
        double was = b.at;
        b.at = fmax(pause, begin);
        if (b.mark >= 1 || b.twin || fabs(b.at - was) > MOVE_MOST || over(&b) > to)
            b.at = was;
        if (b.at != was || roll < KEPT)
            keep(&merged, &b);
    }
    for (size_t k = 0; k < p->phrase_count; k++)
        add_some(&merged, &d, &p->phrases[k], from, begin, to);
    tidy(&merged, first ? first - 1 : 0);
    while (i < blinks->count && merged.count > first &&
           merged.items[merged.count - 1].at > blinks->items[i].at - INTERVAL_SHORTEST)
        merged.count--; /* what follows cannot give way */
    for (; i < blinks->count; i++)
        keep(&merged, &blinks->items[i]);
    blinks_free(blinks);
    *blinks = merged;
}

static double lid(const struct blink *b, double since) {
    double slow = (double)b->slowness;
    double closing = slow * (double)b->closing, open = closing + slow * (double)b->closed;
    if (since <= 0)
        return 0;
    double x = since < closing ? since / closing : 1 - (since - open) / (slow * (double)b->opening);
    return (double)b->depth * life_smooth(x);
}

void blinks_at(struct blinks *blinks, double clock,
               struct blink_factors (*decide)(const void *ctx, double clock), const void *ctx,
               double closed[2]) {
    size_t i = blinks->cursor;
    while (i && blinks->items[i - 1].at > clock - BLINK_LONGEST)
        i--;
    while (i < blinks->count && blinks->items[i].at <= clock - BLINK_LONGEST)
        i++;
    blinks->cursor = i;
    closed[0] = closed[1] = 0;
    for (; i < blinks->count && blinks->items[i].at < clock; i++) {
        struct blink *b = &blinks->items[i];
        if (!b->decided) {
            struct blink_factors f = decide(ctx, b->at);
            b->slowness = (double)b->mark < f.rate ? (float)life_clip(f.length, FASTEST, SLOWEST) : 0;
            b->decided = true;
        }
        if (b->slowness > 0) {
            closed[0] = fmax(closed[0], lid(b, clock - b->at));
            closed[1] = fmax(closed[1], lid(b, clock - b->at - (double)b->lag));
        }
    }
}
