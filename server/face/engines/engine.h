/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visible-speech engines: each makes a layer that moves the mouth from the timed phones. */
#ifndef FACCIA_FACE_ENGINES_ENGINE_H
#define FACCIA_FACE_ENGINES_ENGINE_H

#include "server/face/engines/phone_segments.h"
#include "server/face/face_layer.h"
#include "server/face/track.h"

struct face_engine {
    const char *name;
    /* Applies contacts (contact.h) by default; false for baselines, which serve for comparison. */
    bool contacts;
    /* Tells whether the pack has what the engine needs. */
    bool (*speaks)(const struct speech_pack *pack);
    /* Call only for a pack that it supports. The pack must outlive the layer; the rest may be freed. An
     * engine that computes segments itself, because the voice gave no phones, stores them in g, for
     * contacts and FAP 1. */
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

/* Includes ablations. NULL = the default. Returns NULL for unknown names. */
const struct face_engine *engine_find(const char *name);

/* All engines, NULL-terminated. */
const char *const *engine_names(void);

/* Ablations of the default engine, for measurements, NULL-terminated. */
const char *const *engine_ablations(void);

bool engine_has_contacts(const struct face_engine *engine, enum face_contacts contacts);

#endif
