/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blinks. Private to life*.c. */
#ifndef FACCIA_FACE_LIFE_LIFE_BLINK_H
#define FACCIA_FACE_LIFE_LIFE_BLINK_H

#include "server/face/life/life_shift.h"
#include <stdbool.h>

/* The longest that a blink takes, s, also when it is slowed down. */
#define BLINK_LONGEST 1.2

struct blink {
    double at; /* s on the layer's clock */
    float closing, closed, opening;
    float depth;    /* 1: the lids meet */
    float lag;      /* s that the right eye is behind the left one */
    float mark;     /* it happens when the blink rate's factor is above this */
    bool twin;      /* follows another at once */
    bool decided;   /* whether it happens, and how slowly, is known */
    float slowness; /* 0: does not happen */
};

struct blinks {
    struct blink *items;
    size_t count, cap, cursor;
};

void blinks_free(struct blinks *blinks);

/* Appends a block's blinks while nobody speaks: 17 a minute (A. R. Bentivoglio et al., Movement Disorders 12,
 * 1997), some of them with the large ones among the glances. */
void blinks_of_block(struct blinks *blinks, uint64_t seed, int64_t block, const struct shifts *glances);

/* Moves blinks within the sentence (from..to on the clock) into its pauses and adds as many as make up the
 * 26 a minute of conversation. What can be seen outside stays. */
void blinks_of_speech(struct blinks *blinks, uint64_t seed, const struct prosody *prosody, double from,
                      double to);

/* How far the lids are closed, 0..1, left and right. decide says how a blink that begins at that time is to
 * be: factors of the rate and of the length. It is asked once for each. */
struct blink_factors {
    double rate, length;
};
void blinks_at(struct blinks *blinks, double clock,
               struct blink_factors (*decide)(const void *ctx, double clock), const void *ctx,
               double closed[2]);

#endif
