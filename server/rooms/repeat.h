/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is spoken in a channel, in the manner of the person who listens there, and once more on demand. */
#ifndef FACCIA_ROOMS_REPEAT_H
#define FACCIA_ROOMS_REPEAT_H

#include "server/base/error.h"
#include "server/synthesis/speech_request.h"
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

struct channel;

/* Factors of all that is spoken in a room, MANNER_LEAST to MANNER_MOST. */
#define MANNER_LEAST 0.5
#define MANNER_MOST 2.0
struct manner {
    double speed, pitch, volume; /* 0: 1 */
};

/* Sets the manner from a `manner` message, whose members have been checked; missing ones are 1. */
void channel_set_manner(struct channel *channel, const json_t *message);

/* Speaks the request in the channel's manner, as stream_speak does. A room keeps a copy. */
uint32_t channel_speak(struct channel *channel, const struct speech_request *request, struct error *why);

/* Says the room's last text again, now; a question waits for its answer anew. False: there is none. */
bool channel_repeat(struct channel *channel);

#endif
