/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A language's visible-speech pack, models/speech/LANG.json, read and checked. Immutable once loaded. */
#ifndef FACCIA_FACE_SPEECH_PACK_H
#define FACCIA_FACE_SPEECH_PACK_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"
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

/* All speech packs of a folder, and the choice among them by language tag. */

struct speech_packs {
    struct speech_pack **packs; /* sorted by language tag */
    size_t count, cap;
};

/* Loads every *.json of the folder. -1 with *e ("bad-speech-pack", or the code of a file that it names) when
 * one is broken or there is none; the message names the file. */
int speech_packs_load(struct speech_packs *packs, const char *folder, struct error *e);
void speech_packs_free(struct speech_packs *packs);

/* The tag of the pack for languages that have none of their own (ISO 639-2: undetermined). */
#define SPEECH_PACK_GENERAL "und"

/* The pack for a BCP 47 tag, compared without regard to case: the same tag, else the same language ("it-CH"
 * and "pt" find "it" and "pt-BR", but never somebody's own pack, "it-x-anna"), else the general pack, else
 * NULL. */
const struct speech_pack *speech_packs_find(const struct speech_packs *packs, const char *lang);

/* The pack for what a voice of that language says when `asked` was asked for: asked itself where it is of
 * that language, so that any voice of it can have somebody's own pack; else that of the voice. */
const struct speech_pack *speech_packs_spoken(const struct speech_packs *packs,
                                              const struct speech_pack *asked, const char *lang);

/* Whether it is the one for languages that have none. */
bool speech_pack_is_general(const struct speech_pack *pack);

/* For a sentence in several languages: the pack that knows most of its phones; own when none knows more. (A
 * pack knows the phones of the one that it inherits from.) */
const struct speech_pack *speech_packs_cover(const struct speech_packs *packs, const struct speech_pack *own,
                                             const struct sentence_audio *u);

#endif
