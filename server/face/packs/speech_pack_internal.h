/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the reader of speech packs. Functions return 0, or -1 with the root's error filled. */
#ifndef FACCIA_FACE_SPEECH_PACK_INTERNAL_H
#define FACCIA_FACE_SPEECH_PACK_INTERNAL_H

#include "server/base/error.h"
#include "server/base/json/json_place.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/speech_pack_content.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Reads an object from parameter names to coefficients, overwriting what it names; optional. */
int speech_read_parameters(const struct json_place *at, struct coefficients out[PARAM_COUNT]);

/* "gain" and "shift" of an object for each parameter: target = gain T + shift. */
struct target_change {
    double gain, shift;
};
int speech_read_changes(const struct json_place *at, struct target_change out[PARAM_COUNT]);

int speech_read_groups(struct speech_pack *pack, const struct json_place *at);
int speech_read_phones(struct speech_pack *pack, const struct json_place *at);
void speech_phone_free(struct speech_phone *phone);

/* A phonetic alphabet with articulatory features (models/speech/alphabets/), used to find the most similar
 * phone of a pack. */

struct letter {
    uint32_t code; /* Unicode */
    bool vowel;
    /* vowel: height 0 close..1 open, depth 0 front..1 back, rounded 0 or 1. consonant: place and manner as
     * indices of the lists in transcription.c, voiced 0 or 1. */
    double height, depth, rounded;
    size_t place, manner;
    double voiced;
};

struct alphabet {
    struct letter *letters; /* sorted by code */
    size_t count;
};

/* Returns NULL with *e (field = JSON path) for an invalid file. */
struct alphabet *alphabet_load(const char *path, struct error *e);
void alphabet_free(struct alphabet *alphabet);

const struct letter *alphabet_find(const struct alphabet *alphabet, uint32_t code);

#endif
