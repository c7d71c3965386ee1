/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A nearest-neighbour lip reader: what of the viseme classes can be told from the lips alone. It learns from
 * half of the words and reads the other half. A sample is a phone: the lip FAPs at its middle and at the
 * middles of both neighbours; its class is its viseme group. All features are scaled to unit variance over
 * what was learnt. */
#ifndef FACCIA_EVAL_LIP_READER_H
#define FACCIA_EVAL_LIP_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    READER_FAPS = 22, /* 4-13, 16, 17, 51-60 */
    READER_FEATURES = 3 * READER_FAPS,
    READER_MAX = 4000, /* samples kept in each half: bounds time and memory; what comes later is left out */
};

extern const uint8_t reader_faps[READER_FAPS];

struct lip_reader_sample {
    const void *class; /* identity of its class */
    float features[READER_FEATURES];
};

enum { READER_LEARN, READER_READ, READER_HALVES };

/* Begins zeroed. */
struct lip_reader {
    struct lip_reader_sample *samples[READER_HALVES];
    size_t count[READER_HALVES], cap[READER_HALVES];
};

/* The half to which a word belongs, whatever its ASCII case: the same word is never in both. */
int lip_reader_half(const char *word, size_t size);

void lip_reader_add(struct lip_reader *r, int half, const struct lip_reader_sample *sample);

struct lip_reader_result {
    size_t read, right;
    size_t usual; /* how many would be right if the most frequent class learnt were always said */
};

/* Scales the samples in place, so call it once. */
struct lip_reader_result reader_run(struct lip_reader *r);
void lip_reader_free(struct lip_reader *r);

#endif
