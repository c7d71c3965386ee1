/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The default engine with a part of its function left out, for measuring what that part does. Nobody can ask
 * for them but faccia eval. */
#include "server/face/engines/articulation_layer.h"
#include "server/face/engines/engine.h"

static struct speech_layer without_shape(const struct speech_pack *pack, const struct sentence_audio *u,
                                         struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_NO_SHAPE);
}

static struct speech_layer without_resistance(const struct speech_pack *pack, const struct sentence_audio *u,
                                              struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_NO_RESISTANCE);
}

const struct face_engine engine_without_shape = {"dominance-no-shape", true, articulation_speaks,
                                                 without_shape};
const struct face_engine engine_without_resistance = {"dominance-no-resistance", true, articulation_speaks,
                                                      without_resistance};
