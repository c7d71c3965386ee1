/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corrects phone times. espeak-ng reports a voiceless stop at its burst, so its closure counts as part of
 * the previous phone; unnamed pauses before a phone and sounds spoken within their neighbour need
 * corrections too. Closures and pauses are exact silence in its audio. */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_TIMING_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_TIMING_H

#include "server/plugins/common/espeak_align.h"
#include <stdint.h>

struct es_audio {
    const int16_t *samples;
    uint32_t count, rate;
};

/* Phones with starts from the events; es_time sets the ends. */
struct es_phones {
    struct es_phone *list;
    size_t count, cap;
};

/* Appends a phone. */
struct es_phone *es_phones_add(struct es_phones *phones);

/* Corrects boundaries, sets ends, and merges unnamed phones into their neighbours. word_starts (sorted)
 * are samples: a stop after a pause has its closure from the word's start. */
void es_time(struct es_phones *phones, const struct es_audio *audio, const uint32_t *word_starts,
             size_t word_count);

#endif
