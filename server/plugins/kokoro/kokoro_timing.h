/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phone times from the token durations of Kokoro's encoder. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_TIMING_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_TIMING_H

#include "server/plugins/kokoro/kokoro_tokens.h"

enum {
    KO_RATE = 24000,     /* Hz */
    KO_UNIT = 600,       /* samples per unit of duration: 25 ms */
    KO_SHIFT = 60 * 24,  /* samples by which sounds precede the sum of durations. Measured: the contrast of
                            vowels and voiceless stops peaks at 45 to 65 ms, depending on the voice */
    KO_MARGIN = 24 * 30, /* samples kept before the first sound and after the last */
};

/* A stretch of sound and its phone. */
struct ko_span {
    size_t item;         /* index; SIZE_MAX = a pause */
    uint32_t start, end; /* samples of the kept sound */
};

struct ko_timing {
    uint32_t from, to;    /* kept samples of the piece, without surrounding silence */
    struct ko_span *list; /* contiguous, from 0 to to - from */
    size_t count, cap;
};

/* durations: of the leading token, the items, and the trailing token. Gaps between words are pauses where
 * the sound is quiet, else part of the adjacent phones. */
void ko_time(struct ko_timing *timing, const struct ko_item *items, size_t count, const uint16_t *durations,
             const int16_t *samples, uint32_t sample_count);

#endif
