/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is told of an alignment, sentence by sentence, by the passages of the work: alignment_state.h. */
#ifndef FACCIA_APP_ALIGNER_REPORT_H
#define FACCIA_APP_ALIGNER_REPORT_H

#include "server/align/aligned_recording.h"
#include <jansson.h>

struct aligner_sentences {
    const struct aligned_recording_sentence *list;
    size_t count;
    double rest; /* s of sound behind them */
};

/* Adds figures and lists to the report. text: NUL-terminated; places: [[byte, "SECTION:NAME"]...], in order.
 */
void aligner_report(json_t *report, const struct aligner_sentences *sentences, const char *text,
                    const char *work, const json_t *places);

/* The sentences of a file of times that was written by alignment; to be freed. NULL: there are none. */
struct aligned_recording_sentence *aligner_sentences_kept(const json_t *times, size_t text_size,
                                                          size_t *count);

#endif
