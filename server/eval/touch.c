/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Do lips close where they have to, and does the lower lip get to the teeth? */
#include "server/eval/eval.h"
#include "server/face/engines/contact.h"
#include <math.h>

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

static bool is_seen(const struct eval_input *in, const struct contact *c) {
    double last = floor((in->start + c->end) * in->fps + 1e-9);
    for (double k = ceil((in->start + c->begin) * in->fps - 1e-9); k <= last; k++)
        if (touches(in, c->rule, k / in->fps - in->start))
            return true;
    return false;
}

static bool is_held(const struct eval_input *in, const struct contact *c, double begin, double end) {
    int steps = (int)ceil((end - begin) / EVAL_FINE_STEP);
    for (int i = 0; i <= steps; i++)
        if (!touches(in, c->rule, begin + (end - begin) * i / fmax(1, steps)))
            return false;
    return true;
}

void eval_touch(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    struct contacts contacts;
    contacts_from(g, &contacts);
    for (size_t i = 0; i < contacts.count; i++) {
        const struct contact *c = &contacts.items[i];
        struct eval_touch *touch = c->rule->kind == CONTACT_LIPS ? &e->lips : &e->teeth;
        /* a contact may begin before the first sample, in the rest between sentences, which ends no sooner
         * than there */
        double begin = fmax(c->begin, EVAL_FINE_STEP), end = fmin(c->end, g->end - EVAL_FINE_STEP);
        touch->count++;
        touch->seen += is_seen(in, c);
        touch->held += is_held(in, c, begin, end);
    }
    contacts_free(&contacts);
}
