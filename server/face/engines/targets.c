/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/targets.h"
#include "server/base/mem.h"
#include "server/face/engines/contact.h"
#include <math.h>
#include <stdlib.h>

/* Factors that adapt a pack's coefficients to the original function of Cohen and Massaro (1993). The
 * packs' extents were fitted together with the resistance, which ends segments; without it they would
 * reach over half a sentence and no closure would complete. The two factors per parameter bring the
 * original function closest to the interpolated targets, as found by tests/bench/baseline.c for Italian
 * prose of 20 s at 80, 160 and 320 words a minute. */
static const struct {
    double extent, degree;
} factors[PARAM_COUNT] = {
    [PARAM_LI] = {3.16, 1.2},  /* 1.31 mm from the path through the targets; with {3.16, 1} 1.34 */
    [PARAM_LS] = {6.31, 1.6},  /* 0.51 mm from the path through the targets; with {3.16, 1} 0.54 */
    [PARAM_AR] = {6.31, 1.4},  /* 1.21 mm from the path through the targets; with {3.16, 1} 1.25 */
    [PARAM_PI] = {5.01, 1.2},  /* 0.23 mm from the path through the targets; with {3.16, 1} 0.23 */
    [PARAM_PS] = {6.31, 1.4},  /* 0.26 mm from the path through the targets; with {3.16, 1} 0.27 */
    [PARAM_EM] = {3.16, 1.0},  /* 0.82 mm from the path through the targets; with {3.16, 1} 0.82 */
    [PARAM_TH] = {19.95, 1.8}, /* 1.83 mm from the path through the targets; with {3.16, 1} 2.11 */
    [PARAM_TA] = {2.51, 0.8},  /* 0.41 mm from the path through the targets; with {3.16, 1} 0.44 */
    [PARAM_TB] = {2.51, 1.0},  /* 1.11 mm from the path through the targets; with {3.16, 1} 1.16 */
};

static struct coefficients original_coefficients(const struct coefficients *c, int param) {
    struct coefficients out = *c;
    out.theta_bw = out.theta_fw = factors[param].extent * (c->theta_bw + c->theta_fw) / 2;
    out.c_bw *= factors[param].degree;
    out.c_fw *= factors[param].degree;
    return out;
}

/* A target holds its place against its neighbours from this alpha k on. */
#define HOLDS 0.5

enum { NO_CONTEXT = SPEECH_MAX_CONTEXTS };

enum target_kind { TARGET_CONSONANT, TARGET_VOWEL, TARGET_REST };

/* A target before its neighbours are considered. */
struct raw_target {
    double at;
    struct coefficients c;
    enum target_kind kind;
    double length;   /* duration, s */
    double constant; /* s: undershoot, 0 = none */
    double leaves;   /* where its neighbours' transitions begin: its target, or the touching point if that is
                        beyond */
};

struct raw_list {
    struct raw_target *items;
    size_t count, cap;
};

/* Fraction of the way covered in the duration d. */
static double covered(double d, double constant) {
    return constant > 0 ? 1 - exp(-pow(d / constant, 1.5)) : 1;
}

static bool is_vowel(const struct phone_segment *g) {
    return g->phone && speech_phone_is_vowel(g->phone);
}

struct target_contexts *targets_contexts(const struct phone_segments *g) {
    struct target_contexts *out = mem_alloc((g->count + 1) * sizeof *out);
    size_t vowel = NO_CONTEXT;
    for (size_t i = 0; i < g->count; i++) {
        const struct speech_phone *phone = g->items[i].phone;
        out[i].before = vowel;
        if (!phone)
            vowel = NO_CONTEXT;
        else if (phone->group->vowel)
            vowel = phone->group->context;
    }
    vowel = NO_CONTEXT;
    for (size_t i = g->count; i-- > 0;) {
        const struct speech_phone *phone = g->items[i].phone;
        out[i].after = vowel;
        if (!phone) {
            vowel = NO_CONTEXT;
        } else if (phone->group->vowel) {
            vowel = phone->group->context;
            const struct speech_phone *next = i + 1 < g->count ? g->items[i + 1].phone : NULL;
            out[i].before = out[i].after =
                next && !next->group->vowel ? next->group->context : VOWEL_CONTEXT_PAUSE;
        }
    }
    for (size_t i = 0; i < g->count; i++) {
        if (out[i].before == NO_CONTEXT)
            out[i].before = out[i].after == NO_CONTEXT ? 0 : out[i].after;
        if (out[i].after == NO_CONTEXT)
            out[i].after = out[i].before;
    }
    return out;
}

/* Interpolates all twelve coefficients. */
static struct coefficients between(const struct coefficients *a, const struct coefficients *b,
                                   double weight) {
    struct coefficients out;
    const double *x = (const double *)a, *y = (const double *)b;
    double *z = (double *)&out;
    for (size_t i = 0; i < sizeof out / sizeof(double); i++)
        z[i] = x[i] + weight * (y[i] - x[i]);
    return out;
}

static struct coefficients of_phone(const struct phone_segment *g, const struct target_contexts *contexts,
                                    int p) {
    size_t before = contexts->before * PARAM_COUNT + (size_t)p,
           after = contexts->after * PARAM_COUNT + (size_t)p;
    const struct speech_phone *phone = g->phone;
    if (is_vowel(g))
        return between(&phone->plain[after], &phone->stressed[after], g->stress);
    return between(&phone->plain[before], &phone->plain[after], 0.5);
}

static void add(struct raw_list *list, const struct raw_target *target) {
    if (target->c.alpha <= 0)
        return;
    list->items = mem_grow(list->items, &list->cap, list->count + 1, sizeof *list->items);
    list->items[list->count++] = *target;
}

static void add_rest(struct raw_list *list, double at, const struct speech_rest *rest, int p, double length,
                     double constant) {
    add(list, &(struct raw_target){at, rest->coefficients[p], TARGET_REST, length, constant, 0});
}

static void add_pause(struct raw_list *list, const struct phone_segment *g, const struct speech_rest *rest,
                      int p, bool first, bool last) {
    double length = g->end - g->start, needed = rest->reach + rest->leave;
    if (length < needed && !first && !last) {
        add_rest(list, g->start + length * rest->reach / needed, rest, p, length, rest->partial);
        return;
    }
    if (!first)
        add_rest(list, g->start + fmin(rest->reach, length), rest, p, length, 0);
    if (!last)
        add_rest(list, g->end - fmin(rest->leave, length), rest, p, length, 0);
}

/* Pressed lips start to open from where they touch. */
static bool is_pressed(const struct phone_segment *g, int p) {
    return g->phone->contact.kind == CONTACT_LIPS && (p == PARAM_LI || p == PARAM_LS);
}

static void add_phone(struct raw_list *list, const struct phone_segment *g, const struct coefficients *c,
                      double undershoot, int p) {
    double length = g->end - g->start, at = g->start + c->t * length; /* (3.19) */
    if (is_vowel(g))
        add(list, &(struct raw_target){at, *c, TARGET_VOWEL, length, undershoot, c->T});
    else
        add(list, &(struct raw_target){at, *c, TARGET_CONSONANT, length, 0,
                                       is_pressed(g, p) ? fmax(0, c->T) : c->T});
}

/* Returns the next target on one side that holds against a vowel, skipping vowels and glides, or NULL. */
static const struct raw_target *holding(const struct raw_list *list, size_t i, int side) {
    for (size_t k = i; side < 0 ? k-- > 0 : ++k < list->count;) {
        const struct raw_target *target = &list->items[k];
        if (target->kind != TARGET_VOWEL && target->c.alpha * target->c.k >= HOLDS)
            return target;
    }
    return NULL;
}

/* Fraction of the way from the holding targets on both sides that a vowel reaches. Lips and jaw move
 * through glides, so they have the time between the holding targets; the tongue has a target in nearly
 * every phone, so only the vowel's own time. */
static double reached(const struct raw_list *list, size_t i, int p, double *from) {
    const struct raw_target *self = &list->items[i];
    double sum = 0, weights = 0, distance = 0;
    int sides = 0;
    for (int side = -1; side <= 1; side += 2) {
        const struct raw_target *other = holding(list, i, side);
        if (!other)
            continue;
        sum += other->c.alpha * other->leaves;
        weights += other->c.alpha;
        distance += fabs(other->at - self->at);
        sides++;
    }
    *from = weights > 0 ? sum / weights : self->c.T;
    return covered(p < PARAM_TH && sides ? distance / sides : self->length, self->constant);
}

/* Returns the value that a pause moves away from: the mean of its neighbours. */
static double pause_from(const struct raw_list *list, size_t i) {
    const struct raw_target *self = &list->items[i];
    double sum = 0, weights = 0;
    for (int side = -1; side <= 1; side += 2) {
        if ((side < 0 && i == 0) || (side > 0 && i + 1 == list->count))
            continue;
        const struct raw_target *neighbour = &list->items[side < 0 ? i - 1 : i + 1];
        if (neighbour->kind == self->kind)
            continue;
        sum += neighbour->c.alpha * neighbour->leaves;
        weights += neighbour->c.alpha;
    }
    return weights > 0 ? sum / weights : self->c.T;
}

static double shown(const struct raw_list *list, size_t i, int p) {
    const struct raw_target *self = &list->items[i];
    double from, part;
    if (self->constant <= 0)
        return self->c.T;
    if (self->kind == TARGET_VOWEL) {
        part = reached(list, i, p, &from);
    } else {
        from = pause_from(list, i);
        part = covered(self->length, self->constant);
    }
    return from + part * (self->c.T - from);
}

static void to_curve(const struct raw_list *list, enum targets_function function, int p,
                     struct curve *curve) {
    for (size_t i = 0; i < list->count; i++) {
        struct raw_target target = list->items[i];
        target.c.T = shown(list, i, p);
        if (function == TARGETS_ORIGINAL)
            target.c = original_coefficients(&target.c, p);
        if (function == TARGETS_NO_SHAPE)
            target.c.beta_bw = target.c.beta_fw = 0;
        curve_add(curve, target.at, &target.c);
    }
    if (function == TARGETS_ORIGINAL)
        curve_link_original(curve);
    else if (function == TARGETS_NO_RESISTANCE)
        curve_link_unconfined(curve);
    else
        curve_link(curve);
}

static void make_curve(const struct speech_pack *pack, const struct phone_segments *g,
                       const struct target_contexts *contexts, enum targets_function function, int p,
                       struct raw_list *list, struct curve *curve) {
    double undershoot = function == TARGETS_ORIGINAL ? 0 : pack->undershoot[p];
    struct coefficients *c = mem_alloc((g->count + 1) * sizeof *c);
    for (size_t i = 0; i < g->count; i++)
        if (g->items[i].phone)
            c[i] = of_phone(&g->items[i], &contexts[i], p);
    if (pack->trough >= 0)
        rounding_trough(g, (enum speech_param)p, pack->trough, c);
    list->count = 0;
    add_rest(list, 0, &pack->rest, p, 0, 0);
    for (size_t i = 0; i < g->count; i++) {
        if (g->items[i].phone)
            add_phone(list, &g->items[i], &c[i], undershoot, p);
        else
            add_pause(list, &g->items[i], &pack->rest, p, i == 0, i + 1 == g->count);
    }
    add_rest(list, g->end, &pack->rest, p, 0, 0);
    free(c);
    *curve = (struct curve){0};
    to_curve(list, function, p, curve);
}

void targets_curve(const struct speech_pack *pack, const struct phone_segments *g,
                   enum targets_function function, int param, struct curve *curve) {
    struct target_contexts *contexts = targets_contexts(g);
    struct raw_list list = {0};
    make_curve(pack, g, contexts, function, param, &list, curve);
    free(list.items);
    free(contexts);
}

void targets_curves(const struct speech_pack *pack, const struct phone_segments *g,
                    enum targets_function function, struct curve curves[PARAM_COUNT]) {
    struct target_contexts *contexts = targets_contexts(g);
    struct raw_list list = {0};
    for (int p = 0; p < PARAM_COUNT; p++)
        make_curve(pack, g, contexts, function, p, &list, &curves[p]);
    free(list.items);
    free(contexts);
}
