/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visible-speech engines: each makes a layer that moves the mouth from the same timed phones. */
#ifndef FACCIA_FACE_ENGINES_ENGINE_H
#define FACCIA_FACE_ENGINES_ENGINE_H

#include "server/face/engines/phone_segments.h"
#include "server/face/face_layer.h"
#include "server/face/track.h"

struct face_engine {
    const char *name;
    /* Its layer is followed by that of the contacts (contact.h) unless a request says otherwise: not so of
     * the baselines, which are there to be compared with. */
    bool contacts;
    /* Whether the pack has what the engine needs. */
    bool (*speaks)(const struct speech_pack *pack);
    /* Only for a pack that it speaks. The pack outlives the layer, the rest does not. An engine that makes
     * out segments where the voice gave no phones puts them in g, for the closures and FAP 1. */
    struct speech_layer (*layer)(const struct speech_pack *pack, const struct sentence_audio *u,
                                 struct phone_segments *g);
};

extern const struct face_engine engine_dominance;
extern const struct face_engine engine_cohen_massaro;
extern const struct face_engine engine_context;
extern const struct face_engine engine_syllable;
extern const struct face_engine engine_table;
extern const struct face_engine engine_without_shape;
extern const struct face_engine engine_without_resistance;

/* Ablations included. NULL = the default one. Unknown names find nothing. */
const struct face_engine *engine_find(const char *name);

/* All of them, NULL-terminated. */
const char *const *engine_names(void);

/* The default one without a part of its model, NULL-terminated: for measuring. */
const char *const *engine_ablations(void);

bool engine_has_contacts(const struct face_engine *engine, enum face_contacts contacts);

#endif
