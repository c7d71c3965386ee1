/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Do lips close where they have to, and does the lower lip get to the teeth? Asked of the phones in their own
 * times, as the voice gave them: what the layer of contacts (contact.h) makes of those times does not count.
 */
#include "server/eval/eval.h"
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
