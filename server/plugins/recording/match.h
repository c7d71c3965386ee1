/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the sentence that is asked for stands in a recording's text. */
#ifndef FACCIA_PLUGINS_RECORDING_MATCH_H
#define FACCIA_PLUGINS_RECORDING_MATCH_H

#include "server/align/aligned_recording.h"
#include "server/voice/faccia-voice.h"

struct match {
    struct text_words tokens;        /* of all spans; bytes of the span's text */
    struct text_words before, after; /* of the text around it */
    uint32_t *spans;                 /* whose each is */
    size_t cap;
    size_t at; /* the first one's word in the recording's text */
    const struct faccia_sentence *sentence;
};

/* match starts zeroed. */
void match_words(struct match *match, const struct faccia_sentence *sentence);
void match_free(struct match *match);

/* Sets at: the place whose neighbours agree best with the text around the sentence; of several, the next from
 * that word on, or the first of all. -1 with *e, which says how far the text
 * agrees. */
int match_find(struct match *match, const struct aligned_recording *reading, size_t from, struct error *e);

/* When the word begins or ends, in samples of the stretch that begins at sample `from` and has so many. */
uint64_t match_time(const struct match *match, const struct aligned_recording *reading, size_t word, bool end,
                    uint64_t from, uint64_t samples);

#endif
