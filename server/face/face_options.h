/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a face track is made with, and what it is played with. */
#ifndef FACCIA_FACE_FACE_OPTIONS_H
#define FACCIA_FACE_FACE_OPTIONS_H

#include "server/expression/expressions.h"
#include <stdbool.h>
#include <stdint.h>

/* Of a face track: what is said, and how the author wants it shown. */
struct face_options {
    const char
        *engine; /* NULL = the default one, which also stands in for one that does not speak the pack */
    bool still;  /* lips only: no expressions */
    enum face_blend blend;
    enum face_contacts contacts;
    const struct expressions *expressions; /* the track takes a share; NULL = cues are not shown */
};

/* Of a placement: when it is played, and by whom. */
struct placement_options {
    bool still;              /* no life and no mood */
    double life;             /* strength of the life layer, 0..2; 1 = as people are, 0 = none */
    uint64_t seed;           /* of the life layer: the same seed gives the same face */
    double begin;            /* time of the sentence's start on the life layer's clock, s */
    const struct mood *mood; /* borrowed, may change while the placement is used; NULL = neutral */
};

#endif
