/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A layer that morphs from one key pose to the next. */
#ifndef FACCIA_FACE_ENGINES_MORPH_H
#define FACCIA_FACE_ENGINES_MORPH_H

#include "server/face/face_layer.h"

/* MORPH_SMOOTH: the cubic Hermite curve that stands still at both keys. */
enum morph_ease { MORPH_LINEAR, MORPH_SMOOTH };

struct morph {
    struct morph_key {
        double at;          /* s */
        const double *faps; /* not owned */
    } * keys;               /* at rises strictly */
    size_t count, cap;
    enum morph_ease ease;
};

/* How much of the second key is seen at the part t (0..1) of the way: 3t^2 - 2t^3 (Costa 2009, 4.5), or t. */
double morph_weight(enum morph_ease ease, double t);

/* Adds a key behind the others. One whose time does not come after the last one's is left out: it would never
 * be seen. */
void morph_add(struct morph *morph, double at, const double *faps);

/* The layer takes over the keys. Before the first and after the last one their poses hold. */
struct speech_layer morph_layer(struct morph *morph);

#endif
