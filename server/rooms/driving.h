/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client drives the face of a channel in real time (stream.h); all followers are told who does. */
#ifndef FACCIA_ROOMS_DRIVING_H
#define FACCIA_ROOMS_DRIVING_H

#include "server/base/error.h"
#include "server/stream/drive_track.h"
#include <stddef.h>
#include <stdint.h>

struct channel;
struct rooms;

/* Takes frames of a driver, a number that is not 0 and never used again; the first ones begin the driving.
 * by: its name. voice: its own live voice, or 0. Returns -1 with *e: "driven", "room-away". */
int channel_drive(struct channel *channel, uint64_t driver, const char *by, uint32_t voice,
                  const struct driven_frame *frames, size_t count, struct error *e);

/* Ends the driving, if it is by this driver. */
void channel_undrive(struct channel *channel, uint64_t driver);

/* Ends the driving of rooms whose drivers have fallen silent. Call it once a second. */
void drivings_tick(struct rooms *rooms);

#endif
