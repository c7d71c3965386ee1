/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/rounding.h"

/* Lips that are rounded: at least so far forward, or so much narrower, mm. */
#define ROUNDED_PUSH 1.0
#define ROUNDED_WIDTH (-2.0)
/* Dominance from which a sound rounds the lips itself, and up to which it does not care. */
#define ROUNDS 0.5
#define CARELESS 0.3
/* How firmly the sounds between hold. */
#define HELD 0.6

static bool rounds(const struct coefficients *c, enum speech_param param) {
    return c->alpha >= ROUNDS && (param == PARAM_AR ? c->T <= ROUNDED_WIDTH : c->T >= ROUNDED_PUSH);
}

void rounding_trough(const struct phone_segments *g, enum speech_param param, double trough,
                     struct coefficients *c) {
    if (param != PARAM_AR && param != PARAM_PI && param != PARAM_PS)
        return;
    size_t last = g->count; /* the last one that rounds, with only careless ones since */
    for (size_t i = 0; i < g->count; i++) {
        if (!g->items[i].phone || (c[i].alpha > CARELESS && !rounds(&c[i], param))) {
            last = g->count;
        } else if (rounds(&c[i], param)) {
            double between = last < i ? (1 - trough) * (c[last].T + c[i].T) / 2 : 0;
            for (size_t k = last + 1; k < i; k++) {
                if (g->items[k].phone->contact.kind)
                    continue; /* the lips are busy */
                c[k].T = between;
                c[k].alpha = c[k].k = HELD;
            }
            last = i;
        }
    }
}
