/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A face needs this long for any change, s. */
#define EASE_MIN 0.1
#define EASE_MAX 60

/* What was under way when the mood was set anew runs out within this time, s, and over this way at most. */
#define RUN_OUT 0.25
#define RUN_OUT_WAY 0.05

/* Askings that are remembered, so that times a little before the last one can still be asked for. */
enum { TURNS = 16 };

/* From what was shown at a time to what was asked then. */
struct turn {
    double at, ease;
    double from[AFFECTS_MAX], speed[AFFECTS_MAX], to[AFFECTS_MAX];
    size_t used; /* affects that are not 0 throughout are among the first so many */
};

struct mood {
    const struct expressions *expressions;
    size_t affects;
    struct turn turns[TURNS];
    size_t count; /* of all turns ever; the last TURNS are there, turn k at k % TURNS */
};

struct mood *mood_new(const struct expressions *expressions) {
    struct mood *mood = mem_alloc(sizeof *mood);
    mood->expressions = expressions;
    while (mood->affects < expressions_count(expressions) &&
           !strcmp(expressions_at(expressions, mood->affects)->kind, "affect"))
        mood->affects++;
    return mood;
}

void mood_free(struct mood *mood) {
    free(mood);
}

static const struct turn *turn_at(const struct mood *mood, double clock) {
    size_t k = mood->count, oldest = mood->count > TURNS ? mood->count - TURNS : 0;
    while (k > oldest + 1 && mood->turns[(k - 1) % TURNS].at > clock)
        k--;
    return &mood->turns[(k - 1) % TURNS];
}

/* The way that a speed still makes before it has run out: a cubic that leaves with that speed and comes back
 * to 0, at rest. */
static double run_out(double speed, double since, double *slope) {
    double time = fmin(RUN_OUT, RUN_OUT_WAY / (fabs(speed) * 4 / 27 + 1e-9)), x = since / time;
    *slope = 0;
    if (x >= 1)
        return 0;
    *slope = speed * (1 - x) * (1 - 3 * x);
    return speed * time * x * (1 - x) * (1 - x);
}

static double value_at(const struct turn *turn, size_t i, double clock, double *slope) {
    double since = fmax(0, clock - turn->at), x = since / turn->ease, way = turn->to[i] - turn->from[i];
    *slope = 0;
    if (x >= 1 && since >= RUN_OUT)
        return turn->to[i];
    x = fmin(1, x);
    double bump = run_out(turn->speed[i], since, slope);
    *slope += way * 6 * x * (1 - x) / turn->ease;
    double value = turn->from[i] + way * x * x * (3 - 2 * x) + bump;
    return fmin(1, fmax(0, value));
}

static double amount(double intensity) {
    return intensity > 0 ? fmin(1, intensity) : 0; /* also what is not a number */
}

int mood_set(struct mood *mood, const char *const *names, const double *intensities, size_t count, double at,
             double ease, struct error *e) {
    double to[AFFECTS_MAX] = {0}, sum = 0;
    if (count > MOOD_MIX)
        return error_in_field(e, "bad-value", "mix", "at most %d expressions", MOOD_MIX);
    for (size_t i = 0; i < count; i++) {
        int found = expressions_find(mood->expressions, "affect", names[i]);
        if (found < 0) {
            char field[32];
            snprintf(field, sizeof field, "mix.%zu.name", i);
            return error_in_field(e, "unknown-expression", field, "there is no expression '%.80s'", names[i]);
        }
        to[found] += amount(intensities[i]);
        sum += amount(intensities[i]);
    }
    struct turn next = {.at = at, .ease = ease > EASE_MIN ? fmin(ease, EASE_MAX) : EASE_MIN};
    if (mood->count)
        next.at = fmax(at, mood->turns[(mood->count - 1) % TURNS].at);
    for (size_t i = 0; i < mood->affects; i++) {
        /* More than the whole face there is not. */
        next.to[i] = to[i] / fmax(1, sum);
        if (!mood->count && ease <= 0)
            next.from[i] = next.to[i]; /* it has been so all along */
        else if (mood->count)
            next.from[i] = value_at(turn_at(mood, next.at), i, next.at, &next.speed[i]);
        if (next.to[i] > 0 || next.from[i] > 0)
            next.used = i + 1;
    }
    mood->turns[mood->count++ % TURNS] = next;
    return 0;
}

size_t mood_at(const struct mood *mood, double clock, struct mood_part parts[AFFECTS_MAX]) {
    size_t count = 0;
    if (!mood->count)
        return 0;
    const struct turn *turn = turn_at(mood, clock);
    for (size_t i = 0; i < turn->used; i++) {
        double slope, value = value_at(turn, i, clock, &slope);
        if (value > 0)
            parts[count++] = (struct mood_part){expressions_at(mood->expressions, i), value};
    }
    return count;
}
