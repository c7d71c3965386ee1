/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound of a recording as mono samples, in any format of libsndfile. */
#ifndef FACCIA_SYNTHESIS_RECORDING_INTERNAL_H
#define FACCIA_SYNTHESIS_RECORDING_INTERNAL_H

#include "server/base/sound_reader.h"
#include "server/synthesis/recording.h"

/* Opens the source's sound file, its memory (which is then freed), or a file beside its .fap. *sound is
 * NULL without sound. Returns -1 with *e ("bad-sound"). */
int recording_sound_open(struct sound_reader **sound, struct recording_source *source,
                         const struct reader *reader, const atomic_bool *given_up, struct error *e);

/* Returns the number of samples read, less than `count` at the end. */
uint32_t recording_sound_read(struct sound_reader *sound, int16_t *pcm, uint32_t count);

#endif
