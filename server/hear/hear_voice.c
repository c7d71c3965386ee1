/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_voice.h"
#include <math.h>

/* A frame counts no more than so much; a voice is believed sooner than music. models/hear/README.md has what
 * was tried. */
#define ODDS_MOST 4.0F
#define FALLS 0.015F
#define RISES 0.04F
/* From 1, somebody speaks, to -1; what it has been stays until the evidence is on the other's side. */
#define NONE -0.9F
#define SOMEBODY -0.5F

void hear_voice_begin(struct hear_voice *v) {
    *v = (struct hear_voice){.evidence = 1};
}

void hear_voice_step(struct hear_voice *v, float odds, float silence) {
    float counts = (1 - silence) * fmaxf(-ODDS_MOST, fminf(ODDS_MOST, odds));
    v->evidence = fmaxf(-1, fminf(1, v->evidence + counts * (counts > 0 ? RISES : FALLS)));
    v->none = v->none ? v->evidence < SOMEBODY : v->evidence < NONE;
}
