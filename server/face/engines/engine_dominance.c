/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The default engine: one dominance curve for each articulatory parameter. */
#include "server/face/engines/articulation_layer.h"
#include "server/face/engines/engine.h"

static struct speech_layer layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                 struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_LOOK_AHEAD);
}

const struct face_engine engine_dominance = {"dominance", true, articulation_speaks, layer};
