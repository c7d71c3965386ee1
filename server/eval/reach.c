/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How near vowels come to their targets, and how early their rounding is to be seen. */
#include "server/eval/eval.h"
#include <math.h>

/* What the lips do, mm. */
struct shape {
    double opening, narrowing, protrusion;
};

static struct shape shape_at(const struct eval_input *in, double t) {
    const struct speech_fapu *fapu = &in->pack->fapu;
    struct fap_frame frame;
    in->face.sample(in->face.self, t, &frame);
    const int32_t *v = frame.value;
    return (struct shape){eval_gap(in->pack, &frame), -(v[6] + v[7]) * fapu->mw / 1024,
                          (v[16] + v[17]) / 2.0 * fapu->mns / 1024};
}

static struct shape middle_third(const struct eval_input *in, const struct phone_segment *item) {
    double third = (item->end - item->start) / 3;
    int steps = (int)fmax(1, floor(third / EVAL_FINE_STEP));
    struct shape sum = {0};
    for (int i = 0; i <= steps; i++) {
        struct shape s = shape_at(in, item->start + third + third * i / steps);
        sum.opening += s.opening / (steps + 1);
        sum.narrowing += s.narrowing / (steps + 1);
        sum.protrusion += s.protrusion / (steps + 1);
    }
    return sum;
}

/* A vowel's target for what follows it, between its unstressed and its stressed form, as targets.h has it. */
static double target(const struct phone_segments *g, size_t i, enum speech_param p) {
    const struct phone_segment *item = &g->items[i];
    const struct speech_phone *next = i + 1 < g->count ? g->items[i + 1].phone : NULL;
    size_t context = next && !next->group->vowel ? next->group->context : VOWEL_CONTEXT_PAUSE;
    double plain = item->phone->plain[context * PARAM_COUNT + p].T,
           stressed = item->phone->stressed[context * PARAM_COUNT + p].T;
    return plain + item->stress * (stressed - plain);
}

static struct shape target_shape(const struct phone_segments *g, size_t i) {
    return (struct shape){fmax(0, target(g, i, PARAM_LI) + target(g, i, PARAM_LS)), -target(g, i, PARAM_AR),
                          (target(g, i, PARAM_PI) + target(g, i, PARAM_PS)) / 2};
}

static bool is_rounded(const struct speech_phone *phone) {
    return phone->plain[VOWEL_CONTEXT_PAUSE * PARAM_COUNT + PARAM_AR].T < -EVAL_ROUNDED_MM;
}

static void add(struct eval_reach *r, double reached, double wanted) {
    r->count++;
    r->reached += reached;
    r->target += wanted;
    r->error += fabs(reached - wanted);
}

void eval_reach(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone || !item->phone->group->vowel)
            continue;
        struct shape reached = middle_third(in, item), wanted = target_shape(g, i);
        add(&e->opening, reached.opening, wanted.opening);
        if (!is_rounded(item->phone))
            continue;
        add(&e->rounding, reached.narrowing, wanted.narrowing);
        add(&e->protrusion, reached.protrusion, wanted.protrusion);
        if (i && item[-1].phone && !item[-1].phone->group->vowel)
            add(&e->anticipation, shape_at(in, (item[-1].start + item[-1].end) / 2).narrowing,
                wanted.narrowing);
    }
}
