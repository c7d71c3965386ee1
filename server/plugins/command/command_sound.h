/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes sound of any format of libsndfile to mono, 16 bit. */
#ifndef FACCIA_PLUGINS_COMMAND_COMMAND_SOUND_H
#define FACCIA_PLUGINS_COMMAND_COMMAND_SOUND_H

#include <stddef.h>
#include <stdint.h>

struct cm_sound {
    int16_t *samples;
    size_t count;
    uint32_t rate;
};

/* data is a sound file, or with raw > 0 samples of that rate without a header. Returns -1 with a message.
 * Free sound->samples. A WAV header without a length is corrected in data. */
int cm_sound_read(struct cm_sound *sound, void *data, size_t size, uint32_t raw, char *message, size_t cap);

#endif
