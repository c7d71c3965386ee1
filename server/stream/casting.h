/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses who speaks each item of a score, and finds the sounds that it asks for. */
#ifndef FACCIA_STREAM_CASTING_H
#define FACCIA_STREAM_CASTING_H

#include "server/face/packs.h"
#include "server/voice/cast.h"

/* voice speaks what asks for nothing else. What cannot be had becomes a warning of the score at its place
 * ("unknown-voice", "unknown-language", "no-sound"), and the voice speaks. sounds: folder, or NULL.
 *
 * A named voice speaks, unless the author gives it another language than its own, or a gender. For a language
 * the voices with the wanted gender come first (the author's, else that of the voice before the change), of
 * these those that the language's pack prefers, and of these those of the same plugin. Any thread may call
 * it. */
struct cast *casting(struct score *score, const struct voice *voice, struct voice_list voices,
                     const struct speech_packs *packs, const char *sounds);

#endif
