/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The layer of the engines that have one curve for each articulatory parameter. */
#ifndef FACCIA_FACE_MOUTH_H
#define FACCIA_FACE_MOUTH_H

#include "server/face/targets.h"
#include "server/face/track.h"

/* Any pack will do. */
bool mouth_speaks(const struct speech_pack *pack);

struct face_layer mouth_layer(const struct speech_pack *pack, const struct gestures *g,
                              enum targets_function function);

#endif
