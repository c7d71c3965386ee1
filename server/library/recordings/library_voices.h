/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works with a recording beside them (NAME.flac, .wav, .ogg or .mp3 beside NAME.xml) become a folder of
 * recordings with their texts, as the voice plugin `recording` takes it. For each such work it has
 *   WORK.wav (.flac...)   a link to the sound; WORK.TextGrid (.lab...) one to its times, where they lie
 * beside WORK.txt              what is spoken of it; written only when that is another text WORK.json its
 * name and language WORK.places           the text's passages: {"size", "modified": of the work's file,
 * "lang", "places": [[byte, "SECTION:NAME"]...]} and, from others, WORK.timing.json (times that were found)
 * and WORK.alignment.json (alignment_state.h). */
#ifndef FACCIA_LIBRARY_RECORDINGS_LIBRARY_VOICES_H
#define FACCIA_LIBRARY_RECORDINGS_LIBRARY_VOICES_H

#include "server/base/error.h"
#include "server/base/reader_process.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* Makes the folder, and in it what each such work needs; what is up to date stays, what a process that was
 * killed left unfinished goes. Returns how many there are; what cannot be read is passed over, as the index
 * tells of it. -1 with *e: the folder cannot be written. */
int library_voices_prepare(const char *library, const char *folder, const char *lang,
                           const struct reader *reader, struct error *e);

/* The same for one work and its file, a path in the library. 1 when it has a voice now, 0 when not. *stop,
 * which may be NULL, ends it early, with 0. */
int library_voice_prepare(const char *library, const char *file, const char *work, const char *folder,
                          const char *lang, const struct reader *reader, const atomic_bool *stop,
                          struct error *e);

/* Are there times beside the recording? */
bool library_voice_has_times(const char *folder, const char *work);

#endif
