/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phones and words of sound whose program does not tell their times: found by aligning it to synthetic speech
 * of the same text. */
#ifndef FACCIA_PLUGINS_COMMAND_COMMAND_ALIGN_H
#define FACCIA_PLUGINS_COMMAND_COMMAND_ALIGN_H

#include "server/align/reference.h"
#include "server/align/times.h"
#include "server/plugins/command/command_sound.h"
#include "server/voice/faccia-voice.h"
#include <stdatomic.h>

/* Starts zeroed; the voice to align to is loaded when it is first needed. */
struct cm_aligner {
    struct reference_slot slot;
};
void cm_aligner_close(struct cm_aligner *aligner);

/* -1 with a sentence in message when there is no voice of that language to align to, or the sound is far too
 * short for the text; then the mouth stays closed. Whether it is that of the text is not asked: the program
 * was given it, and of a short sentence the distances would tell too little. */
int cm_align(struct cm_aligner *aligner, const struct cm_sound *sound, const char *text,
             const struct faccia_voice_info *voice, const atomic_bool *stop, struct times *times,
             char *message, size_t cap);

#endif
