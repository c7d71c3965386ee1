/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses who speaks each item of a score, and finds the sounds that it asks for. */
#ifndef FACCIA_SYNTHESIS_SELECT_VOICES_H
#define FACCIA_SYNTHESIS_SELECT_VOICES_H

#include "server/face/packs/speech_packs.h"
#include "server/voice/sentence.h"

/* voice speaks what asks for nothing else. What cannot be had becomes a warning of the script at its place
 * ("unknown-voice", "unknown-language", "no-sound"), and the voice speaks. sounds: folder, or NULL.
 *
 * A named voice speaks, unless the author gives it another language than its own, or a gender. For a language
 * the voices with the wanted gender come first (the author's, else that of the voice before the change), of
 * these those that the language's pack prefers, and of these those of the same plugin. Any thread may call
 * it. */
struct voice_selection *select_voices(struct score *script, const struct voice *voice,
                                      struct voice_list voices, const struct speech_packs *packs,
                                      const char *sounds);

/* The best voice for a language of that gender, as above; NULL when there is none of that gender. */
const struct voice *select_voice_of_gender(const struct voice_pool *pool, const struct speech_packs *packs,
                                           const char *lang, const char *gender, const char *plugin);

#endif
