/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The baseline: the function of Cohen and Massaro (1993) as it was, with the same targets and coefficients.
 * No segment is confined by its neighbours and nothing looks after the closures, so fast speech loses them.
 */
#include "server/face/engines/articulation_layer.h"
#include "server/face/engines/engine.h"

static struct speech_layer layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                 struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_ORIGINAL);
}

const struct face_engine engine_cohen_massaro = {"cohen-massaro", false, articulation_speaks, layer};
