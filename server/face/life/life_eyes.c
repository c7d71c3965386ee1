/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/face/life/life_internal.h"
#include "server/face/life/life_prosody.h"
#include <stdlib.h>

/* Intervals between blinks: log-normal (Bentivoglio et al. 1997). */
#define INTERVAL_MEDIAN 2.9
#define INTERVAL_DEVIATION 0.65
#define INTERVAL_SHORTEST 0.6

/* Deviation of the durations whose medians are in life_internal.h. */
#define DURATION_DEVIATION 0.2
#define SLOWEST 1.8
#define FASTEST 0.6

/* Probabilities of incomplete (M. Doughty, Optom. Vis. Sci. 79, 2002) and double blinks. */
#define INCOMPLETE 0.12
#define SHALLOWEST 0.5
#define TWICE 0.06
#define TWICE_AFTER 0.38
#define LAG 0.002

/* Blinks with gaze shifts: more likely with larger shifts (C. Evinger et al., Exp. Brain Res. 100, 1994). */
#define EVOKED_FROM 8.0
#define EVOKED_SURE 33.0

/* In speech: maximum shift of a blink to the end of a phrase, s, and its accuracy; share kept of those too
 * far away; probability of an additional one at the end of a phrase, and within it per interval in
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

/* Sorts the blinks from index `first` on and drops those too close to another. */
static void sort_and_thin(struct blinks *blinks, size_t first) {
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
    /* the first interval started earlier */
    double at = from + dice_roll(&d) * dice_log_normal(&d, INTERVAL_MEDIAN, INTERVAL_DEVIATION);
    while (at < end) {
        float mark = add(blinks, &d, at)->mark;
        if (dice_roll(&d) < TWICE && at + TWICE_AFTER < end) {
            struct blink *twin = add(blinks, &d, at + TWICE_AFTER);
            twin->twin = true;
            twin->mark = mark; /* depends on the same rate factor as the first */
        }
        double spare = dice_between(&d, last, at); /* optional blinks for a higher rate */
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
    sort_and_thin(blinks, first);
}

/* Returns the phrase end nearest to t on the sentence's clock, searching from the previous result. */
static size_t nearest_end(const struct prosody *p, size_t from, double t) {
    while (from + 1 < p->phrase_count && fabs(p->phrases[from + 1].to - t) <= fabs(p->phrases[from].to - t))
        from++;
    return from;
}

/* Latest end of a blink, even at the slowest. */
static double over(const struct blink *b) {
    return b->at + SLOWEST * (double)(b->closing + b->closed + b->opening) + fabs((double)b->lag);
}

static void keep(struct blinks *blinks, const struct blink *b) {
    blinks->items = mem_grow(blinks->items, &blinks->cap, blinks->count + 1, sizeof *b);
    blinks->items[blinks->count++] = *b;
}

/* Adds a blink that is completely within from..to and postpones later ones. */
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
    sort_and_thin(&merged, first ? first - 1 : 0);
    while (i < blinks->count && merged.count > first &&
           merged.items[merged.count - 1].at > blinks->items[i].at - INTERVAL_SHORTEST)
        merged.count--; /* those outside cannot move */
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

/* Gaze. Directions and sizes of glances: S. P. Lee, J. B. Badler and N. I. Badler, "Eyes Alive", ACM Trans.
 * Graphics 21 (2002). Times of looking away: A. Kendon, Acta Psychologica 26 (1967), where speakers look at
 * the listener about half of the time. Shares of time (75 % while listening, 41 % while speaking) and glances
 * of about 3 s: M. Argyle and M. Cook, "Gaze and Mutual Gaze" (1976). */

/* Glances outside speech: seconds at the listener and away, median and deviation of the logarithm. */
#define LISTENER_MEDIAN 2.7
#define LISTENER_DEVIATION 0.6
#define LISTENER_SHORTEST 1.2
#define AWAY_MEDIAN 1.25
#define AWAY_DEVIATION 0.5
#define AWAY_SHORTEST 0.35
#define AWAY_LONGEST 3.0
/* While speaking. */
#define SPEAKER_MEDIAN 1.1
#define SPEAKER_DEVIATION 0.5
#define SPEAKER_SHORTEST 0.6
#define SPEAKER_AWAY_MEDIAN 1.35
/* Exponentially distributed size (A = -6.9 log(P / 15.7)), with the minimum that counts as looking away. */
#define AWAY_DEGREES 6.9
#define AWAY_SMALLEST 5.0
#define AWAY_LARGEST 20.0
#define AWAY_UP 9.0
#define AWAY_DOWN 12.0

/* Fixations on the listener's eyes, nose and mouth at a distance of one metre. */
#define FIXATION_MEDIAN 0.75
#define FIXATION_DEVIATION 0.6
#define FIXATION_SHORTEST 0.2
#define FIXATION_LONGEST 3.0
#define FIXATION_SCATTER 0.25

/* A saccade takes 21 ms plus 2.2 ms per degree (R. Carpenter, "Movements of the Eyes", 1988). */
#define SACCADE_SECONDS 0.021
#define SACCADE_PER_DEGREE 0.0022

/* The head joins large gaze shifts (J. Stahl, Exp. Brain Res. 126, 1999). */
#define HEAD_FROM 7.0
#define HEAD_SHARE 0.55
#define TURN_SECONDS 0.4
#define TURN_PER_DEGREE 0.03
#define ROLL_PER_YAW (-0.15)

/* While speaking: probability of a glance away at the start of a sentence, and before a phrase, by the
 * lengths of pause and phrase; time before the end of a phrase or sentence at which the gaze returns to the
 * listener. */
#define START 0.85
#define HESITATION 0.5
#define HESITATES 0.85
#define LONG_PHRASE 1.4
#define BEFORE_LONG 0.75
#define BEFORE_SHORT 0.5
#define PHRASE_END 0.15
#define SENTENCE_END 0.35

/* Sentences up to BRIEF s are too short for a turn of the head: one glance of the eyes alone, or none. */
#define PLAN_SHORTEST 0.8
#define BRIEF 1.6
#define BRIEF_CHANCE 0.6
#define BRIEF_SACCADE 0.08 /* s for the way back */

static void aim(struct shift *s, const struct shift *from, double yaw, double pitch) {
    double size = hypot(yaw, pitch), turn = size > HEAD_FROM ? HEAD_SHARE * (size - HEAD_FROM) / size : 0;
    s->to[GAZE_YAW] = (float)yaw;
    s->to[GAZE_PITCH] = (float)pitch;
    s->to[HEAD_PITCH] = (float)(turn * pitch);
    s->to[HEAD_YAW] = (float)(turn * yaw);
    s->to[HEAD_ROLL] = (float)(ROLL_PER_YAW * turn * yaw);
    double way = hypot(yaw - (double)from->to[GAZE_YAW], pitch - (double)from->to[GAZE_PITCH]);
    double head = hypot((double)(s->to[HEAD_YAW] - from->to[HEAD_YAW]),
                        (double)(s->to[HEAD_PITCH] - from->to[HEAD_PITCH]));
    s->fast = (float)(SACCADE_SECONDS + SACCADE_PER_DEGREE * way);
    s->slow = head > 0 ? (float)fmin(TURN_SECONDS + TURN_PER_DEGREE * head, SHIFT_TURN) : 0;
}

static void look(struct shifts *glances, double at, double yaw, double pitch) {
    struct shift s = {.at = at};
    aim(&s, &glances->items[glances->count - 1], yaw, pitch);
    shifts_add(glances, &s);
}

static void look_at_listener(struct shifts *glances, struct dice *d, double at) {
    static const double face[][2] = {{-1.4, -0.4}, {1.4, -0.4}, {0, 1.6}, {0, 0}};
    const double *place = face[dice_bits(d) >> 62];
    double yaw = place[0] + FIXATION_SCATTER * dice_normal(d);
    look(glances, at, yaw, place[1] + FIXATION_SCATTER * dice_normal(d));
}

/* largest: degrees */
static void look_away(struct shifts *glances, struct dice *d, double at, double largest) {
    /* percent of the glances in eight directions from the right, anticlockwise, and their unit vectors */
    static const struct {
        double percent, yaw, pitch;
    } directions[] = {{15.54, -1, 0}, {6.46, -0.7, -0.7}, {17.69, 0, -1}, {7.44, 0.7, -0.7},
                      {16.80, 1, 0},  {7.89, 0.7, 0.7},   {20.38, 0, 1},  {7.79, -0.7, 0.7}};
    double size = fmin(AWAY_SMALLEST - AWAY_DEGREES * log(1 - dice_roll(d)), largest);
    double roll = 100 * dice_roll(d);
    int i = 0;
    while (i < 7 && (roll -= directions[i].percent) > 0)
        i++;
    /* glances are rarely exactly vertical or horizontal */
    double aside = 0.25 * dice_normal(d);
    double yaw = size * (directions[i].yaw + aside * directions[i].pitch);
    double pitch = life_clip(size * (directions[i].pitch - aside * directions[i].yaw), -AWAY_UP, AWAY_DOWN);
    double within = fmin(1, largest / hypot(yaw, pitch));
    look(glances, at, within * yaw, within * pitch);
}

static double fixation(struct dice *d) {
    return life_clip(dice_log_normal(d, FIXATION_MEDIAN, FIXATION_DEVIATION), FIXATION_SHORTEST,
                     FIXATION_LONGEST);
}

static double away(struct dice *d, double median) {
    return life_clip(dice_log_normal(d, median, AWAY_DEVIATION), AWAY_SHORTEST, AWAY_LONGEST);
}

/* Adds fixations of the listener in from..to. */
static void listen(struct shifts *glances, struct dice *d, double from, double to) {
    for (double at = from; at < to; at += fixation(d))
        look_at_listener(glances, d, at);
}

void glances_of_block(struct shifts *glances, uint64_t seed, int64_t block) {
    struct dice d = dice_of(seed, DICE_GLANCES, block);
    double at = life_edge(seed, block), end = life_edge(seed, block + 1) - SHIFT_TURN;
    shifts_add(glances, &(struct shift){.at = at});
    at += fixation(&d);
    for (;;) {
        double stay = fmax(dice_log_normal(&d, LISTENER_MEDIAN, LISTENER_DEVIATION), LISTENER_SHORTEST);
        listen(glances, &d, at, fmin(at + stay, end - FIXATION_SHORTEST));
        at += stay;
        double gone = away(&d, AWAY_MEDIAN);
        if (at + gone > end - FIXATION_SHORTEST)
            break;
        look_away(glances, &d, at, AWAY_LARGEST);
        at += gone;
    }
    if (at < end - FIXATION_SHORTEST) /* too late for a glance, too early for the end */
        listen(glances, &d, at, end - FIXATION_SHORTEST);
    look(glances, end, 0, 0);
}

/* Duration of a glance away at the beginning of a phrase (0 = none), and how long before it starts. */
static double shyness(const struct prosody *p, size_t i, struct dice *d, double *before) {
    const struct phrase *phrase = &p->phrases[i];
    double length = phrase->to - phrase->from, pause = i ? phrase->from - phrase[-1].to : 0, chance;
    *before = 0.7 * (i ? pause : fmin(phrase->from, 0.3));
    if (!i)
        chance = START;
    else if (pause > HESITATION)
        chance = HESITATES;
    else
        chance = length > LONG_PHRASE ? BEFORE_LONG : BEFORE_SHORT;
    double roll = dice_roll(d), gone = *before + away(d, SPEAKER_AWAY_MEDIAN);
    if (length > LONG_PHRASE)
        gone = fmin(gone, *before + 0.75 * length);
    return roll < chance ? gone : 0;
}

/* Plans glances from `from` on, all finished by `to`, on the clock. */
static void plan(struct shifts *out, struct dice *d, const struct prosody *p, double begin, double from,
                 double to) {
    double at = from, last = p->phrase_count ? begin + p->phrases[p->phrase_count - 1].to - SENTENCE_END : to;
    for (size_t i = 0; i < p->phrase_count; i++) {
        const struct phrase *phrase = &p->phrases[i];
        bool longer = phrase->to - phrase->from > LONG_PHRASE;
        double before, gone = shyness(p, i, d, &before), leave = begin + phrase->from - before;
        double end = fmin(longer ? fmin(begin + phrase->to - PHRASE_END, last) : last, to);
        leave = i ? leave : fmax(leave, at);
        do {
            if (gone >= AWAY_SHORTEST && leave >= at && leave + AWAY_SHORTEST <= end) {
                listen(out, d, at, leave - FIXATION_SHORTEST);
                look_away(out, d, leave, AWAY_LARGEST);
                at = fmin(leave + gone, end);
            }
            /* again and again within a long phrase, back for its end */
            leave = fmax(at, leave) +
                    fmax(dice_log_normal(d, SPEAKER_MEDIAN, SPEAKER_DEVIATION), SPEAKER_SHORTEST);
            gone = away(d, SPEAKER_AWAY_MEDIAN);
        } while (longer && leave + AWAY_SHORTEST <= end);
    }
    listen(out, d, at, to);
}

/* Plans the one glance of a brief sentence, finished by `to`. */
static void plan_brief(struct shifts *out, struct dice *d, double from, double to) {
    double gone = fmin(away(d, SPEAKER_AWAY_MEDIAN), to - from), roll = dice_roll(d);
    if (gone >= AWAY_SHORTEST && roll < BRIEF_CHANCE) {
        look_away(out, d, from, 0.99 * HEAD_FROM);
        from += gone;
    }
    listen(out, d, from, to);
}

/* Whether the head is turned or turns in the shifts first..end. */
static bool turns_head(const struct shifts *glances, size_t first, size_t end) {
    for (size_t i = first; i < end; i++)
        if (glances->items[i].slow > 0 || glances->items[i].to[HEAD_PITCH] != 0 ||
            glances->items[i].to[HEAD_YAW] != 0)
            return true;
    return false;
}

void glances_of_speech(struct shifts *glances, uint64_t seed, const struct prosody *prosody, double from,
                       double to) {
    /* all movements end with the sentence */
    bool brief = to - from < BRIEF;
    double take = from + 0.05, back = to - 0.05 - (brief ? BRIEF_SACCADE : SHIFT_TURN);
    if (to - from < PLAN_SHORTEST)
        return;
    size_t first = shifts_find(glances, take) + 1, after = shifts_find(glances, back) + 1;
    if (brief && turns_head(glances, first - 1, after))
        return;
    struct dice d = dice_of(seed, DICE_PLAN, prosody->name);
    struct shifts merged = {0};
    for (size_t i = 0; i < first; i++)
        shifts_add(&merged, &glances->items[i]);
    take = fmax(take, glances->items[first - 1].at + 2 * FIXATION_SHORTEST);
    if (brief)
        plan_brief(&merged, &d, take, back - FIXATION_SHORTEST);
    else
        plan(&merged, &d, prosody, from, take, back - FIXATION_SHORTEST);
    const float *there = glances->items[after - 1].to;
    look(&merged, back, (double)there[GAZE_YAW], (double)there[GAZE_PITCH]);
    for (size_t i = after; i < glances->count; i++)
        shifts_add(&merged, &glances->items[i]);
    shifts_free(glances);
    *glances = merged;
}
