/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes of somebody's voice, as a client sends them, become mono samples. */
#ifndef FACCIA_SYNTHESIS_HEARD_SOUND_H
#define FACCIA_SYNTHESIS_HEARD_SOUND_H

#include "server/synthesis/heard_request.h"

struct heard_sound;

/* NULL with *e: as heard_request_check. */
struct heard_sound *heard_sound_new(const struct heard_request *request, struct error *e);
void heard_sound_free(struct heard_sound *sound);

/* Takes a message: signed 16 bit samples, little endian, of all channels by turns, which may be cut anywhere;
 * or one Opus packet. give gets its samples, at most HEARD_BLOCK at a time. -1 with *e ("bad-sound", at the
 * byte of all that came) when it is no packet: what goes on in its place is what was heard before. */
enum { HEARD_BLOCK = 8192 };
int heard_sound_read(struct heard_sound *sound, const uint8_t *bytes, size_t size,
                     void (*give)(void *ctx, const int16_t *samples, size_t count), void *ctx,
                     struct error *e);

/* Nothing more comes: -1 with *e when the last sample is not whole. */
int heard_sound_end(const struct heard_sound *sound, struct error *e);

#endif
