/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound files that a text asks for. They lie in one folder; nothing else can be named. */
#ifndef FACCIA_VOICE_INSERTED_SOUND_H
#define FACCIA_VOICE_INSERTED_SOUND_H

#include "server/base/error.h"
#include "server/base/reader_process.h"
#include "server/voice/sentence_audio.h"

/* Longer sounds are cut, larger files refused. */
enum { SOUND_SECONDS = 60, SOUND_BYTES_MAX = 64 << 20, SOUND_CHANNELS_MAX = 16 };

/* The file that src means: a path below the folder, as text (no percent signs are decoded, no URL is taken).
 * The caller frees it. NULL with *e ("no-sound") when there is none, or none that may be used. folder NULL =
 * there are no sounds. */
char *sound_find(const char *folder, const char *src, struct error *e);

/* Reads it (base/sound_reader.h), mixed to mono, `volume` times as loud, as a sentence's audio that is one
 * pause. NULL with *e when it cannot be read. *given_up, which may be NULL, ends it. For any thread. */
struct sentence_audio *sound_read(const struct reader *reader, const char *path, double volume,
                                  uint32_t sample_rate, const atomic_bool *given_up, struct error *e);

#endif
