/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of reading a speech pack; speech.c puts them together. All return 0, or -1 with the root's error
 * filled. */
#ifndef FACCIA_FACE_SPEECH_PACK_INTERNAL_H
#define FACCIA_FACE_SPEECH_PACK_INTERNAL_H

#include "server/base/error.h"
#include "server/base/json_place.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/speech_pack_content.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* An object from parameter names to coefficients: overwrites what it names. Nothing to do when it is missing.
 */
int speech_read_parameters(const struct json_place *at, struct coefficients out[PARAM_COUNT]);

/* What "gain" and "shift" beside at's other keys make of the targets of each parameter: gain T + shift. */
struct target_change {
    double gain, shift;
};
int speech_read_changes(const struct json_place *at, struct target_change out[PARAM_COUNT]);

const struct speech_group *speech_find_group(const struct speech_pack *pack, const char *name);

int speech_read_phones(struct speech_pack *pack, const struct json_place *at);
void speech_phone_free(struct speech_phone *phone);

/* {"LI": {"a": {"t": ..., "T": ...}, "any": {...}}, ...} into table[context * PARAM_COUNT + param]; notes in
 * seen (may be NULL) which entries were given. */
int speech_read_targets(const struct json_place *at, char *const *contexts, struct coefficients *table,
                        bool *seen);

/* The parts of reading a table of context-dependent visemes; context_read.c puts them together. Those that
 * return an int return 0, or -1 with the root's error filled. */

/* A phonetic alphabet: its letters with their articulatory features (models/speech/alphabets/), to find what
 * a phone that a pack lacks looks most like. */

struct letter {
    uint32_t code; /* Unicode */
    bool vowel;
    /* vowel: height 0 close..1 open, depth 0 front..1 back, rounded 0 or 1.
     * consonant: place and manner as indices of the lists in alphabet.c, voiced 0 or 1. */
    double height, depth, rounded;
    size_t place, manner;
    double voiced;
};

struct alphabet {
    struct letter *letters; /* sorted by code */
    size_t count;
};

/* NULL with *e (field = JSON path) when the file is not as it must be. */
struct alphabet *alphabet_load(const char *path, struct error *e);
void alphabet_free(struct alphabet *alphabet);

const struct letter *alphabet_find(const struct alphabet *alphabet, uint32_t code);

#endif
