/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bell before an announcement. */
#ifndef FACCIA_SYNTHESIS_BELL_H
#define FACCIA_SYNTHESIS_BELL_H

#include <stdint.h>

enum { BELL_MS = 1400 }; /* the pause after it included */

/* Writes BELL_MS of it: mono samples. volume: factor, as of a request. */
void bell_ring(int16_t *samples, uint32_t count, uint32_t sample_rate, double volume);

#endif
