/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a mouth needs before a sentence is heard. */
#ifndef FACCIA_FACE_LEAD_IN_H
#define FACCIA_FACE_LEAD_IN_H

#include "server/face/packs/speech_pack.h"
#include "server/voice/sentence_audio.h"

/* Lips that are to meet in the first sound have to be on their way before it: to the contact that one frame
 * of 25 a second shows, wherever it falls (CONTACT_MIN_SECONDS), s. People close theirs before they voice a
 * /b/, too. */
#define LEAD_IN_SECONDS 0.06

/* How many samples of silence are missing before the sentence, so that its first sound, where that is a
 * bilabial or a labiodental, has LEAD_IN_SECONDS before it; else 0. Asks the pack alone: sound and times are
 * the same for every engine. */
uint32_t lead_in_missing(const struct speech_pack *pack, const struct sentence_audio *u);

#endif
