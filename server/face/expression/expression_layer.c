/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/expression/expression_layer.h"
#include "server/base/mem.h"
#include "server/base/smoothstep.h"
#include "server/face/engines/fapmap.h"
#include "server/face/expression/cue_envelope.h"
#include "server/face/track.h"
#include <math.h>
#include <stdlib.h>

/* Rise time of cues at the sentence's first sample. */
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

/* Returns 0..1, continuous in value and slope. *cursor is zero-initialised and kept between calls. */
static double activity_at(const struct activity *activity, double t, size_t *cursor) {
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
    /* a product, so that runs shorter than two edges do not jump */
    return smoothstep((t - run->rise) / (run->begin - run->rise)) *
           smoothstep((run->fall - t) / (run->fall - run->end));
}

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out) {
    *out = (struct sentence_expression){.expressions = expressions_share(options->expressions),
                                        .rule = options->blend};
    if (options->expressions)
        cue_envelopes_from(u, options->expressions, options->blend, &out->envelopes);
    if (options->still)
        cue_envelopes_calm(&out->envelopes);
    activity_from(g, &out->activity);
}

void sentence_expression_free(struct sentence_expression *expression) {
    cue_envelopes_free(&expression->envelopes);
    expressions_free(expression->expressions);
    activity_free(&expression->activity);
}

/* Size of a pose: each FAP relative to its range. */
static double size(const struct pose *pose) {
    double sum = 0;
    for (size_t i = 0; i < pose->count; i++)
        sum += fabs(pose->faps[i].value) / fap_table[pose->faps[i].fap].max;
    return sum;
}

void still_expression(const struct expressions *expressions, size_t index, double intensity,
                      struct fap_frame *frame) {
    const struct expression *x = expressions_at(expressions, index);
    double faps[FAP_COUNT + 1] = {0}, shares[BASIC_COUNT + 1];
    struct blend blend = {.face = faps};
    const struct pose *strongest = NULL;
    for (size_t i = 0; i < x->key_count; i++)
        if (!strongest || size(&x->keys[i].pose) > size(strongest))
            strongest = &x->keys[i].pose;
    blend_add(&blend, &x->pose, intensity, x->mouth);
    if (strongest)
        blend_add(&blend, strongest, intensity, x->mouth);
    blend_join(&blend);
    for (int b = 1; b <= BASIC_COUNT; b++)
        shares[b] = x->basics[b] * intensity;
    *frame = (struct fap_frame){.expression = blend_basics(shares)};
    frame->mask[0] |= 2; /* FAP 2 */
    face_limits_apply(face_idle_fapu, faps, frame);
}

/* Weight at which a mood looks in the weighted rule as it does on a silent face: rho times this is 1. */
#define MOOD_WEIGHT (1 / 3.0)

void expression_layer_begin(struct expression_layer *x, const struct sentence_expression *sentence,
                            const struct mood *mood, double begin) {
    static const struct sentence_expression nothing;
    x->sentence = sentence ? sentence : &nothing;
    x->mood = mood;
    x->begin = begin;
    x->at = NAN;
    x->cursor = x->activity_cursor = x->seen_count = 0;
}

static bool is_affect(const struct seen_expression *seen) {
    return !seen->show || seen->show->is_affect;
}

static bool is_weighted(const struct expression_layer *x, const struct seen_expression *seen) {
    return x->sentence->rule == BLEND_WEIGHTED && is_affect(seen);
}

/* Tells whether two cues are combined instead of the newer displacing the older: over the same words they
 * are a mixture, and in the weighted rule successive ones cross-fade linearly by themselves. */
static bool is_beside(const struct cue_envelope *old, const struct cue_envelope *new) {
    return (old->from == new->from && old->to == new->to) || (new->straight && old->to <= new->from);
}

/* A new emotion displaces earlier ones. */
static void give_way(struct expression_layer *x, const struct cue_envelope *to, double level) {
    for (size_t i = 0; i < x->seen_count; i++) {
        struct seen_expression *old = &x->seen[i];
        if (!is_affect(old) || (old->show && is_beside(old->show, to)))
            continue;
        old->level *= 1 - level;
        old->omega *= 1 - level;
    }
}

static void look_at_show(struct expression_layer *x, const struct cue_envelope *show, double t) {
    double level = cue_envelope_level(show, t);
    size_t key;
    double on;
    struct seen_expression seen = {show->expression, level * show->intensity,
                                   level * show->intensity * show->weight, show};
    if (level <= 0 && !cue_envelope_gesture(show, t, &key, &on))
        return;
    if (is_affect(&seen))
        give_way(x, show, level);
    x->seen[x->seen_count++] = seen;
}

/* Collects the visible expressions at t. */
static void look(struct expression_layer *x, double t) {
    x->at = t;
    x->seen_count = 0;
    if (x->mood) {
        struct mood_part parts[AFFECTS_MAX];
        size_t count = mood_at(x->mood, x->begin + t, parts);
        for (size_t i = 0; i < count; i++)
            x->seen[x->seen_count++] = (struct seen_expression){parts[i].expression, parts[i].intensity,
                                                                MOOD_WEIGHT * parts[i].intensity, NULL};
    }
    const struct cue_envelopes *shows = &x->sentence->envelopes;
    while (x->cursor > 0 && shows->latest[x->cursor - 1] > t)
        x->cursor--;
    while (x->cursor < shows->count && shows->latest[x->cursor] <= t)
        x->cursor++;
    size_t end = x->cursor, now = 0;
    for (; end < shows->count && shows->items[end].first <= t; end++)
        now += shows->items[end].last > t;
    for (size_t i = x->cursor; i < end; i++)
        if (shows->items[i].last > t && now-- <= EXPRESSIONS_AT_ONCE)
            look_at_show(x, &shows->items[i], t);
}

static void add_gesture(const struct seen_expression *seen, double t, struct blend *blend) {
    const struct expression *e = seen->expression;
    size_t key;
    double on;
    if (!seen->show || !cue_envelope_gesture(seen->show, t, &key, &on))
        return;
    blend_add(blend, &e->keys[key].pose, (1 - on) * seen->show->reach, e->mouth);
    blend_add(blend, &e->keys[key + 1].pose, on * seen->show->reach, e->mouth);
}

void expression_layer_blend(struct expression_layer *x, double t,
                            const struct contact_demand demand[CONTACT_TEETH + 1], double faps[FAP_COUNT + 1],
                            struct fap_expression *basic) {
    double shares[BASIC_COUNT + 1] = {0};
    look(x, t);
    *basic = (struct fap_expression){0};
    if (!x->seen_count)
        return;
    struct blend blend = {.rule = x->sentence->rule, .face = faps};
    double articulation = 1, omega = 0;
    blend.activity = activity_at(&x->sentence->activity, t, &x->activity_cursor);
    blend.contact = fmax(demand[CONTACT_LIPS].weight, demand[CONTACT_TEETH].weight);
    for (size_t i = 0; i < x->seen_count; i++) {
        articulation *= 1 + (x->seen[i].expression->articulation - 1) * x->seen[i].level;
        omega += is_weighted(x, &x->seen[i]) ? x->seen[i].omega : 0;
    }
    blend_speech(&blend, articulation, omega);
    for (size_t i = 0; i < x->seen_count; i++) {
        const struct seen_expression *seen = &x->seen[i];
        const struct expression *e = seen->expression;
        double shown = seen->level;
        if (is_weighted(x, seen)) {
            shown = blend_shown(seen->omega);
            blend_add_weighted(&blend, &e->pose, seen->omega);
        } else {
            blend_add(&blend, &e->pose, seen->level, e->mouth);
        }
        add_gesture(seen, t, &blend);
        for (int b = 1; b <= BASIC_COUNT; b++)
            shares[b] += e->basics[b] * shown;
    }
    blend_join(&blend);
    *basic = blend_basics(shares);
}

static void factors_at(void *ctx, double t, struct life_factors *out) {
    struct expression_layer *x = ctx;
    *out = (struct life_factors){1, 1, 1};
    if (x->at != t)
        look(x, t);
    for (size_t i = 0; i < x->seen_count; i++) {
        const struct life_factors *life = &x->seen[i].expression->life;
        double level = x->seen[i].level;
        out->blink_rate *= 1 + (life->blink_rate - 1) * level;
        out->blink_length *= 1 + (life->blink_length - 1) * level;
        out->motion *= 1 + (life->motion - 1) * level;
    }
}

struct life_influence expression_layer_influence(struct expression_layer *x) {
    return (struct life_influence){factors_at, x};
}
