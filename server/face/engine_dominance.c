/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The default engine: one dominance curve for each articulatory parameter. */
#include "server/base/mem.h"
#include "server/face/engine.h"
#include "server/face/fapmap.h"
#include "server/face/targets.h"
#include <stdlib.h>

struct mouth {
    struct speech_fapu fapu;
    struct curve curves[PARAM_COUNT];
    struct curve_cursor cursors[PARAM_COUNT];
};

static void add(void *self, double t, double faps[FAP_COUNT + 1]) {
    struct mouth *mouth = self;
    double mm[PARAM_COUNT];
    for (int p = 0; p < PARAM_COUNT; p++)
        mm[p] = curve_at(&mouth->curves[p], t, &mouth->cursors[p]);
    fapmap_add(&mouth->fapu, mm, faps);
}

static void mouth_free(void *self) {
    struct mouth *mouth = self;
    for (int p = 0; p < PARAM_COUNT; p++)
        curve_free(&mouth->curves[p]);
    free(mouth);
}

static struct face_layer layer(const struct speech_pack *pack, const struct gestures *g) {
    struct mouth *mouth = mem_alloc(sizeof *mouth);
    mouth->fapu = pack->fapu;
    targets_curves(pack, g, mouth->curves);
    return (struct face_layer){add, mouth_free, mouth};
}

const struct face_engine engine_dominance = {"dominance", layer};
