/* SPDX-License-Identifier: MIT */
/* The adaptive arithmetic coder of the FBA bitstream (ISO/IEC 14496-2, 7.12 and annex B): 16-bit registers,
 * and one stuffing bit after 22 zeros so that no start code appears. */
#ifndef FACCIA_PROTOCOL_FBA_ARITH_H
#define FACCIA_PROTOCOL_FBA_ARITH_H

#include "protocol/fba/fba_bits.h"

enum {
    FBA_RANGE_STEP = 60, /* ranges are stated in these many quantiser steps */
    FBA_RANGE_MAX = 31,  /* of these */
    FBA_SYMBOLS_MAX = 2 * FBA_RANGE_STEP * FBA_RANGE_MAX + 1,
    FBA_TOTAL_MAX = 16383, /* at which the frequencies are halved */
    FBA_LOOK_AHEAD = 14,   /* bits that a decoder has read beyond the end of a codeword */
};

/* Frequencies of the values min..max, at first 1 each. */
struct fba_model {
    int min, max;
    uint32_t total;
    uint16_t sums[FBA_SYMBOLS_MAX + 1]; /* Fenwick tree, 1-based */
};

void fba_model_reset(struct fba_model *model, int min, int max);

struct fba_decoder {
    struct fba_bits *bits;
    uint32_t low, high, code;
    unsigned zeros;
    size_t read;     /* number of code bits read */
    size_t ends[16]; /* where the latest code bits end */
    size_t bad;      /* position of a stuffing bit that is 0; SIZE_MAX: none */
};

/* Begins a codeword. */
void fba_decoder_begin(struct fba_decoder *decoder, struct fba_bits *bits);
/* Returns a value of the model. adapt: count it. */
int fba_decode(struct fba_decoder *decoder, struct fba_model *model, bool adapt);
/* Ends the codeword and moves the position behind it. Returns NULL, or what is wrong at the position. */
const char *fba_decoder_end(struct fba_decoder *decoder);

struct fba_encoder {
    struct fba_sink *sink;
    uint32_t low, high;
    size_t opposite;
    unsigned zeros;
};

void fba_encoder_begin(struct fba_encoder *encoder, struct fba_sink *sink);
/* value: within the model. */
void fba_encode(struct fba_encoder *encoder, struct fba_model *model, int value, bool adapt);
void fba_encoder_end(struct fba_encoder *encoder);

#endif
