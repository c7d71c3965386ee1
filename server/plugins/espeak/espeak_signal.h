/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the samples say about a boundary between phones. */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_SIGNAL_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_SIGNAL_H

#include <stdint.h>

struct es_audio {
    const int16_t *samples;
    uint32_t count, rate;
};

/* Where the silence that ends at `end` begins, not before `from`. Silence is what is weaker than the echo of
 * the loudest sample in [heard, end); with heard = end, it is silence indeed. */
uint32_t es_silence_start(const struct es_audio *audio, uint32_t from, uint32_t end, uint32_t heard);

/* Where a nasal or liquid that began at `from` opens into its vowel, if the vowel was reported at `at`: the
 * engine reports it after the transition, by 10 to 30 ms too late. The opening is where the energy of the
 * differenced signal passes the geometric mean of the consonant's and the vowel's. Returns `at` when there is
 * no clear rise. */
uint32_t es_release(const struct es_audio *audio, uint32_t from, uint32_t at);

#endif
