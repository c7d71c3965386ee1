/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A language's visible-speech pack, models/speech/LANG.json, read and checked. Immutable once loaded. */
#ifndef FACCIA_FACE_PACKS_SPEECH_PACK_H
#define FACCIA_FACE_PACKS_SPEECH_PACK_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

struct speech_pack;

/* Loads path; "inherits" names another pack in the same folder. NULL with *e (field = JSON path) when it is
 * not as it must be. */
struct speech_pack *speech_pack_load(const char *path, struct error *e);
void speech_pack_free(struct speech_pack *pack);

const char *speech_pack_lang(const struct speech_pack *pack); /* BCP 47: "it" */
const char *speech_pack_name(const struct speech_pack *pack); /* in the language itself: "italiano" */

/* Voice ids to be tried first for this language, NULL-terminated. */
const char *const *speech_pack_voices(const struct speech_pack *pack);

/* Abbreviations (lower case, without the final dot) after which a full stop ends no sentence,
 * NULL-terminated. */
const char *const *speech_pack_abbreviations(const struct speech_pack *pack);

#endif
