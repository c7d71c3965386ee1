/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fundamental frequency at one place: autocorrelation of about 40 ms, averaged down to some 2.7 kHz. */
#include "server/face/life/life_prosody.h"
#include <math.h>
#include <stdlib.h>

enum { RATE = 2750, WINDOW = 64, LONGEST = 40, SHORTEST = 6 }; /* lags: 69 to 458 Hz */
#define VOICED 0.55

static int32_t product(const int16_t *a, const int16_t *b) {
    int32_t sum = 0;
    for (int i = 0; i < WINDOW; i++)
        sum += a[i] * b[i];
    return sum;
}

double prosody_pitch(const struct sentence_audio *u, uint32_t sample) {
    uint32_t step = u->sample_rate / RATE, size = (WINDOW + LONGEST) * step;
    if (!u->pcm || !step || u->samples < size)
        return 0;
    uint32_t from = sample > size / 2 ? sample - size / 2 : 0;
    if (from > u->samples - size)
        from = u->samples - size;
    int32_t sums[WINDOW + LONGEST], loudest = 1, mean = 0;
    for (uint32_t i = 0; i < WINDOW + LONGEST; i++) {
        const int16_t *pcm =
            u->pcm + from + i * step; /* four of them are enough to keep most of the noise out */
        sums[i] = pcm[0] + pcm[step / 4] + pcm[step / 2] + pcm[3 * step / 4];
        mean += sums[i] / (WINDOW + LONGEST);
    }
    for (int i = 0; i < WINDOW + LONGEST; i++) {
        sums[i] -= mean;
        loudest = abs(sums[i]) > loudest ? abs(sums[i]) : loudest;
    }
    /* eleven bits and the sign, so that the products of a window add up within 32 bits */
    int16_t x[WINDOW + LONGEST];
    float scale = 2047.0f / (float)loudest;
    for (int i = 0; i < WINDOW + LONGEST; i++)
        x[i] = (int16_t)((float)sums[i] * scale);
    int32_t own = product(x, x), other = product(x + SHORTEST, x + SHORTEST);
    float best = 0, likeness[LONGEST + 1] = {0};
    for (int lag = SHORTEST; lag <= LONGEST; lag++) {
        int32_t common = product(x, x + lag);
        likeness[lag] = common > 0 ? (float)common / sqrtf((float)own * (float)other) : 0;
        best = fmaxf(best, likeness[lag]);
        if (lag < LONGEST)
            other += x[lag + WINDOW] * x[lag + WINDOW] - x[lag] * x[lag];
    }
    if (best < (float)VOICED)
        return 0;
    /* the first peak that is nearly as high as the highest: not its double */
    int lag = SHORTEST + 1;
    while (lag < LONGEST && (likeness[lag] < (float)0.88 * best || likeness[lag] < likeness[lag - 1] ||
                             likeness[lag] < likeness[lag + 1]))
        lag++;
    if (lag == LONGEST)
        return 0;
    float a = likeness[lag - 1], b = likeness[lag], c = likeness[lag + 1], bend = a - 2 * b + c;
    double shift = bend < 0 ? (double)((a - c) / (2 * bend)) : 0;
    return (double)u->sample_rate / step / (lag + shift);
}
