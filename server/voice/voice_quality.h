/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes the quality of a finished voice: spectral tilt, breath, jitter, shimmer and tremor, on the samples,
 * so that any voice can be tense, breathy or harsh. The number of samples and all times stay: no sound
 * moves by more than 3 ms, so the lips need not move. After C. Drioli, P. Cosi, F. Tesser, G. Tisato,
 * "Emotions and voice quality" (Voqual 2003). */
#ifndef FACCIA_VOICE_VOICE_QUALITY_H
#define FACCIA_VOICE_VOICE_QUALITY_H

#include "server/markup/score.h"
#include <stdint.h>

/* Changes samples [from, to) of a sound of `samples`, with a short ramp at each end. The stretch becomes
 * no louder (root of the mean square) than before, and its peak no higher than before or than 1 dB below full
 * scale. The same input gives the same output. */
void voice_quality_apply(int16_t *pcm, uint32_t samples, uint32_t sample_rate, uint32_t from, uint32_t to,
                         const struct score_quality *quality);

#endif
