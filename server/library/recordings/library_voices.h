/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files FOLDER/WORKENDING that are replaced atomically. */
#ifndef FACCIA_LIBRARY_RECORDINGS_LIBRARY_VOICES_H
#define FACCIA_LIBRARY_RECORDINGS_LIBRARY_VOICES_H

#include "server/base/error.h"
#include "server/base/work/reader_process.h"
#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

int kept_set_json(const char *folder, const char *work, const char *ending, const json_t *value,
                  struct error *e);

/* NULL: it does not exist or is not JSON. */
json_t *kept_json(const char *folder, const char *work, const char *ending);

/* Modification time in ns since the epoch. */
int64_t kept_time(const struct stat *file);

/* Works with a recording beside them (NAME.flac, .wav, .ogg or .mp3 beside NAME.xml), and EPUBs with media
 * overlays, become a folder of recordings with their texts, in the layout of the voice plugin `recording`:
 * WORK.wav (.flac...), a link to the sound; WORK.TextGrid (.lab...), a link to its times if they exist;
 * WORK.txt, the spoken text, rewritten only when it changes; WORK.json, name and language; WORK.places, the
 * passages of the text:
 * {"size", "modified": of the work's file, "lang", "places": [[byte, "SECTION:NAME"]...]}. Other code adds
 * WORK.timing.json (aligned times) and WORK.alignment.json (alignments.h). */

/* Creates the folder and what each such work needs in it; keeps what is up to date and removes temporary
 * files of killed processes. Returns the number of works with a voice; unreadable works are skipped, as
 * the index reports them. -1 with *e: the folder cannot be written. */
int library_voices_prepare(const char *library, const char *folder, const char *lang,
                           const struct reader *reader, struct error *e);

/* The same for one work and its file, relative to the library. 1: it has a voice; 0: none. *stop, which
 * may be NULL, ends it early, with 0. */
int library_voice_prepare(const char *library, const char *file, const char *work, const char *folder,
                          const char *lang, const struct reader *reader, const atomic_bool *stop,
                          struct error *e);

/* True when there are times beside the recording. */
bool library_voice_has_times(const char *folder, const char *work);

#endif
