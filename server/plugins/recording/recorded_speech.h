/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence as it is heard in a recording, as fast as it is asked for. */
#ifndef FACCIA_PLUGINS_RECORDING_RECORDED_SPEECH_H
#define FACCIA_PLUGINS_RECORDING_RECORDED_SPEECH_H

#include "server/plugins/recording/folder.h"
#include "server/plugins/recording/match.h"

/* Gives sound, phones, words and marks of the words that were matched, and warns of what cannot be done with
 * a recording. pause: the longest after them, s. */
void recorded_speech_give(const struct match *match, const struct recorded *recorded, double pause,
                          const struct faccia_sink *sink);

#endif
