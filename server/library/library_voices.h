/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works with a recording beside them (NAME.flac, .wav, .ogg or .mp3 beside NAME.xml) become a folder of
 * recordings with their texts, as the voice plugin `recording` takes it. */
#ifndef FACCIA_LIBRARY_LIBRARY_VOICES_H
#define FACCIA_LIBRARY_LIBRARY_VOICES_H

#include "server/base/error.h"
#include <stddef.h>

/* Makes the folder, and in it for each such work a link to its sound, its text and a description; what is up
 * to date stays. Returns how many there are; what cannot be read is passed over, as the index tells of it. -1
 * with *e: the folder cannot be written. */
int library_voices_prepare(const char *library, const char *folder, const char *lang, struct error *e);

#endif
