/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound files, of any kind that libsndfile reads, as mono of 16 bit. */
#ifndef FACCIA_PLUGINS_COMMAND_COMMAND_SOUND_H
#define FACCIA_PLUGINS_COMMAND_COMMAND_SOUND_H

#include <stddef.h>
#include <stdint.h>

struct cm_sound {
    int16_t *samples;
    size_t count;
    uint32_t rate;
};

/* From a file's bytes. raw: they are samples of that rate without a header; 0 = a sound file. -1 with a
 * sentence in message. Free sound->samples. A WAV header without a length is mended in data. */
int cm_sound_read(struct cm_sound *sound, void *data, size_t size, uint32_t raw, char *message, size_t cap);

#endif
