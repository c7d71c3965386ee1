/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a face track consists of, for those who play it. */
#ifndef FACCIA_FACE_TRACK_INTERNAL_H
#define FACCIA_FACE_TRACK_INTERNAL_H

#include "server/face/engines/opening.h"
#include "server/face/engines/viseme.h"
#include "server/face/expression/sentence_expression.h"
#include "server/face/face_layer.h"
#include "server/face/track.h"
#include <stdatomic.h>

struct face_track {
    atomic_uint owners;
    struct speech_fapu fapu;
    double end; /* s */
    struct speech_layer speech;
    struct contacts contacts;
    struct openings openings;
    struct visemes visemes;
    bool still;
    struct sentence_expression expression; /* of nothing when still */
};

#endif
