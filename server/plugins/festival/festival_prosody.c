/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/festival/festival_prosody.h"
#include <math.h>

#define STRETCH_MIN 0.25
#define STRETCH_MAX 4.0
#define FACTOR_MIN 0.25
#define FACTOR_MAX 4.0
#define RAMP_SECONDS 0.004 /* time constant */

/* Samples above KNEE are bent so that none passes LIMIT. */
#define KNEE 24000.0
#define LIMIT 32000.0

static double between(double low, double x, double high) {
    return x < low ? low : x > high ? high : x;
}

struct fe_prosody fe_prosody_of(const struct fe_voice *voice, const struct faccia_span *span) {
    /* rate, pitch, range, volume for each level: none, reduced, weak, medium, strong */
    static const double levels[][4] = {
        {1, 1, 1, 1}, {1.1, 0.95, 0.8, 0.85}, {1, 1, 1, 1}, {0.92, 1.08, 1.2, 1.15}, {0.85, 1.15, 1.4, 1.3}};
    const double *level = levels[span->emphasis < 5 ? span->emphasis : 4];
    double rate = (span->rate > 0 ? span->rate / voice->info.rate : 1) * level[0];
    struct fe_prosody p = {
        .pitch = (span->pitch > 0 ? span->pitch : 1) * level[1],
        .range = (span->range >= 0 ? span->range : 1) * level[2],
        .volume = (span->volume >= 0 ? span->volume : 1) * level[3],
    };
    p.stretch = between(STRETCH_MIN, rate > 0 ? 1 / rate : 1, STRETCH_MAX);
    p.pitch = between(FACTOR_MIN, p.pitch, FACTOR_MAX);
    p.range = between(0.01, p.range, FACTOR_MAX);
    p.volume = between(0, p.volume, FACTOR_MAX);
    return p;
}

static double bend(double x) {
    double size = fabs(x);
    return size <= KNEE ? x : copysign(KNEE + (LIMIT - KNEE) * tanh((size - KNEE) / (LIMIT - KNEE)), x);
}

void fe_amplify(int16_t *samples, size_t from, size_t to, uint32_t sample_rate, double gain, double volume,
                double *now) {
    const double step = 1 - exp(-1 / (RAMP_SECONDS * sample_rate));
    for (size_t i = from; i < to; i++) {
        *now += (volume - *now) * step;
        samples[i] = (int16_t)lrint(bend(samples[i] * gain * *now));
    }
}
