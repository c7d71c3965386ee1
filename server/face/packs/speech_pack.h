/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A language's visible-speech pack, models/speech/LANG.json, and the choice among packs. Immutable once
 * loaded. */
#ifndef FACCIA_FACE_SPEECH_PACK_H
#define FACCIA_FACE_SPEECH_PACK_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"
#include <stdbool.h>
#include <stddef.h>

struct speech_pack;

/* Loads path; "inherits" names another pack in the same folder. Returns NULL with *e (field = JSON path)
 * when it is invalid. */
struct speech_pack *speech_pack_load(const char *path, struct error *e);
void speech_pack_free(struct speech_pack *pack);

const char *speech_pack_lang(const struct speech_pack *pack); /* BCP 47: "it" */
const char *speech_pack_name(const struct speech_pack *pack); /* in the language itself: "italiano" */

/* Ids of preferred voices, NULL-terminated. */
const char *const *speech_pack_voices(const struct speech_pack *pack);

/* Abbreviations (lower case, without the final dot) after which a full stop does not end a sentence,
 * NULL-terminated. */
const char *const *speech_pack_abbreviations(const struct speech_pack *pack);

/* All speech packs of a folder. */

struct speech_packs {
    struct speech_pack **packs; /* sorted by language tag */
    size_t count, cap;
};

/* Loads every *.json of the folder. Returns -1 with *e ("bad-speech-pack", or the code of a referenced
 * file) when one is invalid or there is none; the message names the file. */
int speech_packs_load(struct speech_packs *packs, const char *folder, struct error *e);
void speech_packs_free(struct speech_packs *packs);

/* The pack for languages without their own (ISO 639-2: undetermined). */
#define SPEECH_PACK_GENERAL "und"

/* Finds the pack for a BCP 47 tag, ignoring case: the same tag, else the same language ("it-CH" and "pt"
 * find "it" and "pt-BR", but never a private pack, "it-x-anna"), else the general pack, else NULL. */
const struct speech_pack *speech_packs_find(const struct speech_packs *packs, const char *lang);

/* Finds the pack for a voice of that language: `asked` if it has the same language, so that any voice can
 * be used with a private pack; else the pack of the voice's language. */
const struct speech_pack *speech_packs_spoken(const struct speech_packs *packs,
                                              const struct speech_pack *asked, const char *lang);

/* Tells whether it is the general pack. */
bool speech_pack_is_general(const struct speech_pack *pack);

/* For a sentence in several languages: returns the pack that knows most of its phones, `own` if none knows
 * more. (A pack includes the phones it inherits.) */
const struct speech_pack *speech_packs_cover(const struct speech_packs *packs, const struct speech_pack *own,
                                             const struct sentence_audio *u);

#endif
