/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where phones really begin and end. espeak-ng reports a voiceless stop at its burst, so that its closure is
 * billed to the phone before; pauses that it puts before a phone without naming them, and sounds that it says
 * inside their neighbour, need the same care. Closures and pauses are exact silence in its audio. */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_TIMING_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_TIMING_H

#include "server/plugins/common/espeak_align.h"
#include <stdint.h>

struct es_audio {
    const int16_t *samples;
    uint32_t count, rate;
};

/* A list of phones whose starts are the events' times, and whose ends are yet to be found. */
struct es_phones {
    struct es_phone *list;
    size_t count, cap;
};

/* Adds a phone at the end. */
struct es_phone *es_phones_add(struct es_phones *phones);

/* Corrects the boundaries, sets the ends, and lets phones without a name be part of their neighbours.
 * word_starts (sorted) are the samples where words begin: before a stop that follows a pause, that is where
 * its closure begins. */
void es_time(struct es_phones *phones, const struct es_audio *audio, const uint32_t *word_starts,
             size_t word_count);

#endif
