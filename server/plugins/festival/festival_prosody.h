/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Festival is to do to a span's durations and fundamental frequency, and the plugin to its samples. */
#ifndef FACCIA_PLUGINS_FESTIVAL_FESTIVAL_PROSODY_H
#define FACCIA_PLUGINS_FESTIVAL_FESTIVAL_PROSODY_H

#include "server/plugins/festival/festival_voices.h"

/* Factors, 1 = as the voice does it. */
struct fe_prosody {
    double stretch; /* of durations */
    double pitch;   /* of the mean fundamental frequency */
    double range;   /* of its range in octaves */
    double volume;  /* of the samples */
};

/* Emphasis is mapped to the same four. Emotions come as factors already (models/expressions.json). */
struct fe_prosody fe_prosody_of(const struct fe_voice *voice, const struct faccia_span *span);

/* Multiplies the samples [from, to) by gain times a volume, which moves there from *now within some ms; what
 * would not fit 16 bits is bent. */
void fe_amplify(int16_t *samples, size_t from, size_t to, uint32_t sample_rate, double gain, double volume,
                double *now);

#endif
