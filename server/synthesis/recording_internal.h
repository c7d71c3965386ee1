/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sound of a recording, in any format that libsndfile reads, as mono samples. */
#ifndef FACCIA_SYNTHESIS_RECORDING_INTERNAL_H
#define FACCIA_SYNTHESIS_RECORDING_INTERNAL_H

#include "server/base/sound_reader.h"
#include "server/synthesis/recording.h"

/* From the source's sound file, its memory (which is freed), or a file beside its .fap; *sound = NULL when
 * there is none. -1 with *e: "bad-sound". */
int recording_sound_open(struct sound_reader **sound, struct recording_source *source,
                         const struct reader *reader, const atomic_bool *given_up, struct error *e);

/* Returns how many there were; fewer than `count` at the end. */
uint32_t recording_sound_read(struct sound_reader *sound, int16_t *pcm, uint32_t count);

#endif
