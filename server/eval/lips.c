/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lips do: whether they touch, how they move, how far they reach. */
#include "server/eval/eval.h"
#include "server/face/engines/fapmap.h"
#include <math.h>

/* Do lips close where they have to, and does the lower lip get to the teeth? Asked of the phones in their own
 * times, as the voice gave them: what the layer of contacts (contact.h) makes of those times does not count.
 */

/* FAPs are rounded to units, so that a lip that is exactly at its place may seem off by half of one. */
#define HALF_UNIT 0.5

static bool touches(const struct eval_input *in, const struct contact_rule *rule, double t) {
    double unit = in->pack->fapu.mns / 1024;
    struct fap_frame frame;
    in->face.sample(in->face.self, t, &frame);
    if (rule->kind == CONTACT_LIPS)
        return eval_gap(in->pack, &frame) <= 0;
    /* as high as the teeth's edge, and as far back */
    return (frame.value[5] + HALF_UNIT) * unit >= -rule->reach &&
           (frame.value[16] - HALF_UNIT) * unit <= -rule->retract;
}

/* In a frame that is on the screen while the phone sounds: frame k is shown from k / fps to the next one. */
static bool is_seen(const struct eval_input *in, const struct phone_segment *item) {
    double last = floor((in->start + item->end) * in->fps - 1e-9);
    for (double k = floor((in->start + item->start) * in->fps + 1e-9); k <= last; k++)
        if (touches(in, &item->phone->contact, k / in->fps - in->start))
            return true;
    return false;
}

/* Throughout the middle third of the phone: its beginning belongs to the way there, its end to the release.
 */
static bool is_held(const struct eval_input *in, const struct phone_segment *item) {
    double third = (item->end - item->start) / 3, begin = item->start + third;
    int steps = (int)ceil(third / EVAL_FINE_STEP);
    for (int i = 0; i <= steps; i++)
        if (!touches(in, &item->phone->contact, begin + third * i / fmax(1, steps)))
            return false;
    return true;
}

void eval_touch(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone || !item->phone->contact.kind)
            continue;
        struct eval_touch *touch = item->phone->contact.kind == CONTACT_LIPS ? &e->lips : &e->teeth;
        touch->count++;
        touch->seen += is_seen(in, item);
        touch->held += is_held(in, item);
    }
}

/* How fast the lips move, how smoothly, and whether they pass through each other. */

static void measure_frames(struct eval *e, const struct eval_input *in, double end) {
    double gaps[4] = {0}; /* the last four, newest first */
    int known = 0;
    for (double k = ceil(in->start * in->fps - 1e-9); k / in->fps - in->start <= end; k++) {
        struct fap_frame frame;
        in->face.sample(in->face.self, k / in->fps - in->start, &frame);
        for (int i = 3; i > 0; i--)
            gaps[i] = gaps[i - 1];
        gaps[0] = eval_gap(in->pack, &frame);
        known++;
        if (known >= 2)
            e->speed = fmax(e->speed, fabs(gaps[0] - gaps[1]) * in->fps);
        if (known >= 4)
            e->jerk = fmax(e->jerk, fabs(gaps[0] - 3 * gaps[1] + 3 * gaps[2] - gaps[3]) * pow(in->fps, 3));
    }
}

void eval_motion(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    static const int pairs[3][2] = {{4, 5}, {8, 10}, {9, 11}}; /* middle, left, right */
    double unit = in->pack->fapu.mns / 1024;
    measure_frames(e, in, g->end);
    for (double t = 0; t <= g->end; t += EVAL_FINE_STEP) {
        struct fap_frame frame;
        in->face.sample(in->face.self, t, &frame);
        for (int i = 0; i < 3; i++) {
            /* both values are rounded: one unit is no overlap */
            double overlap =
                (frame.value[pairs[i][0]] + frame.value[pairs[i][1]] - 1) * unit - FAPMAP_MAX_PRESS;
            e->overlap = fmax(e->overlap, overlap);
        }
    }
}

/* How near vowels come to their targets, and how early their rounding is to be seen. */

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
