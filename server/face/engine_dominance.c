/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The default engine: one dominance curve for each articulatory parameter. */
#include "server/face/engine.h"
#include "server/face/mouth.h"

static struct face_layer layer(const struct speech_pack *pack, const struct utterance *u,
                               struct gestures *g) {
    (void)u;
    return mouth_layer(pack, g, TARGETS_LOOK_AHEAD);
}

const struct face_engine engine_dominance = {"dominance", true, mouth_speaks, layer};
