/* SPDX-License-Identifier: MIT */
/* Used by the reader and the writer of FBA frames: ranges of values, and the models of a group of frames. */
#ifndef FACCIA_PROTOCOL_FBA_PLANE_H
#define FACCIA_PROTOCOL_FBA_PLANE_H

#include "protocol/fba/fba.h"
#include "protocol/fba/fba_arith.h"

enum {
    FBA_GROUPS = 10,
    FBA_MASK_FAP = 1, /* bits of fba_object_mask */
    FBA_MASK_BODY = 2,
    FBA_HIGH =
        7, /* parts of FAP 1 and 2: select1, select2, blend; select1, intensity1, select2, intensity2 */
};

/* First FAP of each group, and one past the last. */
extern const uint8_t fba_group_begin[FBA_GROUPS + 1];

/* Ranges as the stream states them: in FBA_RANGE_STEP quantiser steps, indexed by FAP. */
struct fba_ranges {
    uint8_t i_max[FAP_COUNT + 1], i_min[FAP_COUNT + 1], p_max[FAP_COUNT + 1], p_min[FAP_COUNT + 1];
};

/* Those that hold until the stream states others. */
void fba_ranges_init(struct fba_ranges *ranges);

struct fba_plane {
    uint8_t mask[FAP_MASK_BYTES];
    int quant;
    struct fba_ranges ranges;
    int32_t shown[FAP_COUNT + 1]; /* what a decoder has reconstructed */
    int high_shown[FBA_HIGH];
    struct fba_model values[FAP_COUNT + 1], high[FBA_HIGH]; /* of P frames */
    struct fba_model even;                                  /* of I frames, which adapt to nothing */
};

static inline bool fba_plane_has(const struct fba_plane *plane, int n) {
    return plane->mask[(n - 1) / 8] >> ((n - 1) % 8) & 1;
}

/* FAP units of a level; at least 1. */
static inline int fba_step(int n, int quant) {
    return quant ? fap_table[n].quant_step * quant : 1;
}

/* Levels that a stated range allows. */
static inline int fba_levels(int stated, int quant) {
    return stated * FBA_RANGE_STEP / (quant ? quant : 1);
}

/* Prepares the models that an I frame resets. */
void fba_plane_reset(struct fba_plane *plane);

/* Returns the model that codes the values of FAP n, 3 to 68. */
struct fba_model *fba_plane_model(struct fba_plane *plane, int n, bool intra);

/* Highest value of a part of FAP 1 or 2 in levels. */
int fba_high_most(int part, int quant);
/* FAP units of its level. */
static inline int fba_high_step(int part, int quant) {
    return (part == 2 || part == 4 || part == 6) && quant ? quant : 1;
}

#endif
