/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ARKit's face shapes as FAPs, generated from models/shapes/arkit.json at build time. */
#ifndef FACCIA_CODEC_ARKIT_TABLE_H
#define FACCIA_CODEC_ARKIT_TABLE_H

#include "protocol/fap.h"
#include <stdbool.h>

/* Indices that make-arkit-table.py checks against the file. */
enum {
    ARKIT_EYE_BLINK_LEFT = 0,
    ARKIT_EYE_BLINK_RIGHT = 7,
    ARKIT_JAW_RIGHT = 15,
    ARKIT_JAW_LEFT = 16,
    ARKIT_JAW_OPEN = 17,
    ARKIT_MOUTH_CLOSE = 18,
    ARKIT_MOUTH_RIGHT = 21,
    ARKIT_MOUTH_LEFT = 22,
    ARKIT_TONGUE_OUT = 51,
    ARKIT_SHAPES = 52
};

struct arkit_shape {
    const char *name;            /* "eyeBlinkLeft" */
    bool rare;                   /* used only for strong movements */
    int32_t faps[FAP_COUNT + 1]; /* at weight 1, FAP units */
};

/* In the order of Live Link Face's columns. */
extern const struct arkit_shape arkit_table[ARKIT_SHAPES];

#endif
