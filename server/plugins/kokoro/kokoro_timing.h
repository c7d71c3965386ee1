/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Times of phones, from the durations that Kokoro's encoder gives to its tokens. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_TIMING_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_TIMING_H

#include "server/plugins/kokoro/kokoro_tokens.h"

enum {
    KO_RATE = 24000,     /* Hz */
    KO_UNIT = 600,       /* samples in one unit of duration: 25 ms */
    KO_SHIFT = 60 * 24,  /* samples by which the sounds come before the sum of the durations. Measured: the
                            contrast of vowels and voiceless stops is greatest at 45 to 65 ms, by voice */
    KO_MARGIN = 24 * 30, /* samples that are kept before the first sound and after the last */
};

/* A stretch of sound with what is said in it. */
struct ko_span {
    size_t item;         /* index; SIZE_MAX: a pause */
    uint32_t start, end; /* samples of the kept sound */
};

struct ko_timing {
    uint32_t from, to;    /* samples of the piece that are kept: without the silence round it */
    struct ko_span *list; /* touching; from 0 to to - from */
    size_t count, cap;
};

/* durations: for the token before, those of the items, and the one behind. Gaps between words are pauses
 * where the sound is quiet; elsewhere they belong to the phones beside them. */
void ko_time(struct ko_timing *timing, const struct ko_item *items, size_t count, const uint16_t *durations,
             const int16_t *samples, uint32_t sample_count);

#endif
