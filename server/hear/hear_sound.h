/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound of any rate and number of channels, as it comes, brought to what the features want: 16 kHz, mono,
 * without its mean. In what pieces it comes makes no difference to a single bit. */
#ifndef FACCIA_HEAR_HEAR_SOUND_H
#define FACCIA_HEAR_HEAR_SOUND_H

#include "server/base/error.h"
#include <stdbool.h>

enum {
    HEAR_RATE = 16000,
    HEAR_RATE_LEAST = 8000,
    HEAR_RATE_MOST = 96000,
    HEAR_CHANNELS_MOST = 8,
};

struct hear_sound;

/* take gets what has become ready, at most 20 ms at a time. NULL with *e (bad-sound) when the rate or the
 * number of channels is out of range. */
struct hear_sound *hear_sound_new(unsigned rate, unsigned channels,
                                  void (*take)(void *ctx, const float *samples, size_t count), void *ctx,
                                  struct error *e);
void hear_sound_free(struct hear_sound *sound);

/* Samples from -1 to 1, of all channels by turns; frames of one sample each. What is no number counts as
 * silence, what is louder is clipped. */
void hear_sound_write(struct hear_sound *sound, const float *samples, size_t frames);

/* There is no more: gives what is left. */
void hear_sound_end(struct hear_sound *sound);

#endif
