/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/bell.h"
#include <math.h>

/* Two notes, a major third down. Old ears hear best below 2 kHz, so the partials stay there. */
static const struct note { double at, hz; /* s */ } notes[] = {{0, 659.26}, {0.42, 523.25}};
static const double partials[][2] = {{1, 0.7}, {2, 0.22}, {3, 0.08}}; /* multiple, part of the level */

#define LEVEL 0.35   /* of full scale: as loud as speech */
#define DECAY 0.22   /* s, to 1/e */
#define ATTACK 0.006 /* s */
#define TWO_PI 6.283185307179586

static double struck(const struct note *note, double t) {
    double sum = 0;
    t -= note->at;
    if (t < 0)
        return 0;
    for (unsigned i = 0; i < sizeof partials / sizeof *partials; i++)
        sum += partials[i][1] * sin(TWO_PI * partials[i][0] * note->hz * t);
    return sum * exp(-t / DECAY) * fmin(1, t / ATTACK);
}

void bell_ring(int16_t *samples, uint32_t count, uint32_t sample_rate, double volume) {
    for (uint32_t i = 0; i < count; i++) {
        double value = 0;
        for (unsigned k = 0; k < sizeof notes / sizeof *notes; k++)
            value += struck(&notes[k], (double)i / sample_rate);
        samples[i] = (int16_t)lrint(32767 * fmax(-1, fmin(1, LEVEL * volume * value)));
    }
}
