/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sound that goes to a daemon, as fast as it is spoken: what a microphone gives through a pipe, samples
 * without a header, or a file that libsndfile reads. */
#ifndef FACCIA_DOORS_LIVE_SOUND_H
#define FACCIA_DOORS_LIVE_SOUND_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stdint.h>

struct live_sound;

/* name: a file, or "-". rate 0: the file tells it. NULL after a message. */
struct live_sound *live_sound_open(const char *name, unsigned rate, unsigned channels);
void live_sound_close(struct live_sound *sound);

unsigned live_sound_rate(const struct live_sound *sound);
unsigned live_sound_channels(const struct live_sound *sound);
/* It waits for nobody: a microphone. A file does. */
bool live_sound_flows(const struct live_sound *sound);

/* Writes the samples that are due, 16 bit little endian, by a clock in microseconds that begins with the
 * first call; false at the end. What is not asked for is left where it is, in a pipe or a file. */
bool live_sound_read(struct live_sound *sound, uint64_t now, struct buf *samples);

#endif
