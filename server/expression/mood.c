/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Minimum time of any change, s. */
#define EASE_MIN 0.1
#define EASE_MAX 60

/* A previous change still in progress ends within this time, s, and this distance. */
#define RUN_OUT 0.25
#define RUN_OUT_WAY 0.05

/* Changes kept, so that times slightly before the last one can be evaluated. */
enum { CHANGES = 16 };

/* An affect's change from the shown to the requested intensity. */
struct way {
    size_t affect;
    double from, speed, to;
};

/* The affects of one change, in order; all others are 0 before and after. */
struct mood_change {
    double at, ease;
    size_t count;
    struct way ways[];
};

struct mood {
    const struct expressions *expressions;
    size_t affects;
    struct mood_change *changes[CHANGES];
    size_t count; /* of all changes ever; change k is at k % CHANGES, the last CHANGES are kept */
};

struct mood *mood_new(const struct expressions *expressions) {
    struct mood *mood = mem_alloc(sizeof *mood);
    mood->expressions = expressions_share(expressions);
    while (mood->affects < expressions_count(expressions) &&
           !strcmp(expressions_at(expressions, mood->affects)->kind, "affect"))
        mood->affects++;
    return mood;
}

void mood_free(struct mood *mood) {
    for (size_t i = 0; mood && i < CHANGES; i++)
        free(mood->changes[i]);
    if (mood)
        expressions_free(mood->expressions);
    free(mood);
}

static const struct mood_change *change_at(const struct mood *mood, double clock) {
    size_t k = mood->count, oldest = mood->count > CHANGES ? mood->count - CHANGES : 0;
    while (k > oldest + 1 && mood->changes[(k - 1) % CHANGES]->at > clock)
        k--;
    return mood->changes[(k - 1) % CHANGES];
}

/* Displacement left by a change in progress: a cubic that starts with its speed and returns to 0 at rest. */
static double run_out(double speed, double since, double *slope) {
    double time = fmin(RUN_OUT, RUN_OUT_WAY / (fabs(speed) * 4 / 27 + 1e-9)), x = since / time;
    *slope = 0;
    if (x >= 1)
        return 0;
    *slope = speed * (1 - x) * (1 - 3 * x);
    return speed * time * x * (1 - x) * (1 - x);
}

static double value_at(const struct mood_change *change, const struct way *w, double clock, double *slope) {
    double since = fmax(0, clock - change->at), x = since / change->ease, way = w->to - w->from;
    *slope = 0;
    if (x >= 1 && since >= RUN_OUT)
        return w->to;
    x = fmin(1, x);
    double bump = run_out(w->speed, since, slope);
    *slope += way * 6 * x * (1 - x) / change->ease;
    double value = w->from + way * x * x * (3 - 2 * x) + bump;
    return fmin(1, fmax(0, value));
}

/* Returns an affect's value at a time, and its slope. */
static double shown(const struct mood *mood, size_t affect, double clock, double *slope) {
    const struct mood_change *change = change_at(mood, clock);
    *slope = 0;
    for (size_t i = 0; i < change->count; i++)
        if (change->ways[i].affect == affect)
            return value_at(change, &change->ways[i], clock, slope);
    return 0;
}

static double amount(double intensity) {
    return intensity > 0 ? fmin(1, intensity) : 0; /* also replaces NaN */
}

int mood_set(struct mood *mood, const char *const *names, const double *intensities, size_t count, double at,
             double ease, struct error *e) {
    double to[AFFECTS_MAX] = {0}, sum = 0;
    if (count > MOOD_MIX)
        return error_in_field(e, ERROR_BAD_VALUE, "mix", "at most %d expressions", MOOD_MIX);
    for (size_t i = 0; i < count; i++) {
        int found = expressions_find(mood->expressions, "affect", names[i]);
        if (found < 0) {
            char field[32], text[SUGGESTIONS_TEXT];
            struct suggestions near = expressions_near(mood->expressions, "affect", names[i]);
            snprintf(field, sizeof field, "mix.%zu.name", i);
            return error_in_field(e, ERROR_UNKNOWN_EXPRESSION, field, "unknown expression '%.80s'%s",
                                  names[i], suggestions_text(&near, text));
        }
        to[found] += amount(intensities[i]);
        sum += amount(intensities[i]);
    }
    if (mood->count)
        at = fmax(at, mood->changes[(mood->count - 1) % CHANGES]->at);
    struct way ways[AFFECTS_MAX];
    size_t used = 0;
    for (size_t i = 0; i < mood->affects; i++) {
        /* intensities add up to at most 1 */
        struct way way = {.affect = i, .to = to[i] / fmax(1, sum)};
        if (mood->count)
            way.from = shown(mood, i, at, &way.speed);
        else if (ease <= 0)
            way.from = way.to; /* in effect from the start */
        if (way.to > 0 || way.from > 0)
            ways[used++] = way;
    }
    struct mood_change *next = mem_alloc(sizeof *next + used * sizeof *ways);
    *next = (struct mood_change){
        .at = at, .ease = ease > EASE_MIN ? fmin(ease, EASE_MAX) : EASE_MIN, .count = used};
    memcpy(next->ways, ways, used * sizeof *ways);
    struct mood_change **place = &mood->changes[mood->count++ % CHANGES];
    free(*place);
    *place = next;
    return 0;
}

size_t mood_at(const struct mood *mood, double clock, struct mood_part parts[AFFECTS_MAX]) {
    size_t count = 0;
    if (!mood->count)
        return 0;
    const struct mood_change *change = change_at(mood, clock);
    for (size_t i = 0; i < change->count; i++) {
        double slope, value = value_at(change, &change->ways[i], clock, &slope);
        if (value > 0)
            parts[count++] =
                (struct mood_part){expressions_at(mood->expressions, change->ways[i].affect), value};
    }
    return count;
}
