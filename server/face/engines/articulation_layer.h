/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The layer of the engines that have one curve for each articulatory parameter. */
#ifndef FACCIA_FACE_ENGINES_ARTICULATION_LAYER_H
#define FACCIA_FACE_ENGINES_ARTICULATION_LAYER_H

#include "server/face/engines/targets.h"
#include "server/face/face_layer.h"

/* Any pack will do. */
bool articulation_speaks(const struct speech_pack *pack);

struct speech_layer articulation_layer(const struct speech_pack *pack, const struct phone_segments *g,
                                       enum targets_function function);

#endif
