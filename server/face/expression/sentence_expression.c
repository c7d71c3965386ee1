/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/expression/sentence_expression.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

/* What begins at the sentence's very first sample rises within it. */
#define EDGE 0.1

static void activity_from(const struct phone_segments *g, struct activity *out) {
    *out = (struct activity){0};
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone || item->end <= item->start)
            continue;
        if (out->count && item->start - out->runs[out->count - 1].end < 2 * ACTIVITY_RAMP) {
            out->runs[out->count - 1].end = item->end;
            continue;
        }
        out->runs = mem_grow(out->runs, &out->cap, out->count + 1, sizeof *out->runs);
        out->runs[out->count++] = (struct activity_run){.begin = item->start, .end = item->end};
    }
    for (size_t i = 0; i < out->count; i++) {
        struct activity_run *run = &out->runs[i];
        run->rise = fmax(0, run->begin - ACTIVITY_RAMP);
        run->fall = fmin(g->end, run->end + ACTIVITY_RAMP);
        run->begin = fmax(run->begin, run->rise + EDGE);
        run->end = fmin(run->end, run->fall - EDGE);
    }
}

static void activity_free(struct activity *activity) {
    free(activity->runs);
    *activity = (struct activity){0};
}

static double smooth(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

double activity_at(const struct activity *activity, double t, size_t *cursor) {
    size_t i = *cursor;
    while (i > 0 && t < activity->runs[i - 1].fall)
        i--;
    while (i < activity->count && t >= activity->runs[i].fall)
        i++;
    *cursor = i;
    if (i == activity->count)
        return 0;
    const struct activity_run *run = &activity->runs[i];
    if (t <= run->rise)
        return 0;
    /* A product, so that a run of less than two edges does not jump. */
    return smooth((t - run->rise) / (run->begin - run->rise)) *
           smooth((run->fall - t) / (run->fall - run->end));
}

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out) {
    *out = (struct sentence_expression){.expressions = expressions_share(options->expressions),
                                        .rule = options->blend};
    if (options->expressions)
        cue_envelopes_from(u, options->expressions, options->blend, &out->envelopes);
    activity_from(g, &out->activity);
}

void sentence_expression_free(struct sentence_expression *expression) {
    cue_envelopes_free(&expression->envelopes);
    expressions_free(expression->expressions);
    activity_free(&expression->activity);
}
