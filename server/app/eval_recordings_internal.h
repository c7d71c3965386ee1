/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia eval --recording found. */
#ifndef FACCIA_APP_EVAL_RECORDINGS_INTERNAL_H
#define FACCIA_APP_EVAL_RECORDINGS_INTERNAL_H

#include "server/app/eval_options.h"
#include "server/eval/person_reader.h"

enum { OTHER = STRETCH_ENGINES, LINES };

/* What one line of the table sums over the recordings. */
struct line {
    double count[PERSON_MEASURES], sum[PERSON_MEASURES][6]; /* r, rms, affine, shift, r and rms there */
    struct lip_reader reader;
    struct lip_reader_result read;
    bool there;
};

struct recordings {
    const struct eval_options *options;
    const struct speech_pack *pack;
    struct measured_speech *people, *others;
    struct eval_variant variants[STRETCH_ENGINES];
    size_t variant_count;
    bool use[PERSON_MEASURES]; /* what all people have, for the reader */
    struct line lines[LINES];
};

/* The table, or the JSON file. The exit code. */
int recordings_write(const struct recordings *r);

#endif
