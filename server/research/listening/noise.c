/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/research/listening/stimuli_set.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* SplitMix64 (Steele, Lea and Flood, OOPSLA 2014), as a number from -1 to 1. */
static double draw(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) / (double)(1ull << 52) - 1;
}

double noise_mix(const int16_t *speech, size_t samples, size_t from, size_t to, double snr, uint64_t seed,
                 int16_t *out) {
    double *noise = mem_alloc(samples * sizeof *noise);
    double speech_power = 0, noise_power = 0, peak = 0, scale = 0;
    for (size_t i = 0; i < samples; i++)
        noise[i] = draw(&seed);
    for (size_t i = from; i < to && i < samples; i++) {
        speech_power += (double)speech[i] * speech[i];
        noise_power += noise[i] * noise[i];
    }
    memset(out, 0, samples * sizeof *out);
    if (speech_power > 0 && noise_power > 0) {
        double gain = sqrt(speech_power / noise_power * pow(10, -snr / 10));
        for (size_t i = 0; i < samples; i++) {
            noise[i] = speech[i] + gain * noise[i];
            peak = fmax(peak, fabs(noise[i]));
        }
        scale = INT16_MAX / peak;
        for (size_t i = 0; i < samples; i++)
            out[i] = (int16_t)lround(scale * noise[i]);
    }
    free(noise);
    return scale;
}
