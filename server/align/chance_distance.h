/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How near other words of the same two voices come, which tells whether a distance is that of the same words:
 * it depends on the speakers more than on the words. */
#ifndef FACCIA_ALIGN_CHANCE_DISTANCE_H
#define FACCIA_ALIGN_CHANCE_DISTANCE_H

#include "server/align/align.h"
#include "server/align/reference.h"

/* Aligned words come nearer than this share of what other words come. Measured: the same words 0.81 to 0.91
 * (0.95 where a man is aligned to a woman), others 0.98 to 1.05 (Festival's voices and readers of LibriVox,
 * aligned to espeak-ng). */
#define CHANCE_SHARE 0.955

/* The mean distance of the first words of the speech (about 10 s) from the recording, beginning where that
 * begins, when they are spoken in reverse order; and, in *apart, that of the same words as they were aligned.
 * Negative when there are too few words to tell. */
double chance(const struct align_sound *recording, const struct reference_speech *speech,
              const struct align_map *map, const atomic_bool *stop, double *apart);

#endif
