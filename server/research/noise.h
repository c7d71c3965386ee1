/* SPDX-License-Identifier: GPL-3.0-or-later */
/* White noise over speech at a given signal-to-noise ratio (Costa, MSc thesis, UNICAMP 2009, chapter 6). */
#ifndef FACCIA_RESEARCH_NOISE_H
#define FACCIA_RESEARCH_NOISE_H

#include <stddef.h>
#include <stdint.h>

/* Mixes noise of uniform distribution, the same for the same seed, over all samples; out has room for as
 * many. The ratio of the mean squares of speech and noise within [from, to) is exactly snr dB. The sum is
 * then scaled so that its peak is full scale. Returns that scale; 0, with out silent, when the segment is
 * empty or silent (there is no such ratio). */
double noise_mix(const int16_t *speech, size_t samples, size_t from, size_t to, double snr, uint64_t seed,
                 int16_t *out);

#endif
