/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rooms that there are, what is kept for those in which nobody is, and how other daemons share them. */
#ifndef FACCIA_ROOMS_ROOMS_H
#define FACCIA_ROOMS_ROOMS_H

#include "server/base/error.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include <jansson.h>
#include <stdbool.h>

struct bus;
struct channel;
struct rooms;

struct room_limits {
    unsigned queue; /* utterances that wait on one stream */
    unsigned rooms; /* that have somebody in them */
    unsigned
        address_rooms;   /* that one address, or subject, had made, and that have somebody in them; 0: any */
    unsigned send_bytes; /* unsent bytes at which a stream of one's own waits for its listener */
    unsigned hold_seconds; /* what is said to an empty room waits so long for somebody; 0: it does not */
};

/* A command for a room that this daemon leads, from another daemon or one of its own clients: runs it, and
 * returns the answer, as HTTP has it; a new reference. The command is an object: `type`; `request` of what is
 * to be spoken (request_to_json); `message` of a client, of the other types; `by`, who asks; `payer` and
 * `asker` (speech_request.h). remote: which daemon asks, 0: this one; number: the command's among those of
 * all. `utterance` of the answer, which HTTP has not, is the number of what will be spoken. */
typedef json_t *rooms_run(void *ctx, const char *room, const json_t *command, uint64_t remote,
                          uint64_t number, unsigned *status);

/* The pipeline outlives it. */
struct rooms *rooms_open(const struct pipeline *pipeline, const struct room_limits *limits, rooms_run *run,
                         void *ctx);
void rooms_change(struct rooms *rooms, const struct room_limits *limits);

/* Rooms are shared with other daemons from now on, until rooms_unshare: before the bus is closed. */
void rooms_share(struct rooms *rooms, struct bus *bus);
void rooms_unshare(struct rooms *rooms);

void rooms_tick(struct rooms *rooms); /* once a second */
void rooms_close(struct rooms *rooms);
void rooms_free(struct rooms *rooms);

/* Of all rooms; channel_next has the others. NULL: there is none. */
struct channel *rooms_first(const struct rooms *rooms);

/* The room of that name; NULL: there is none. */
struct channel *channel_find(const struct rooms *rooms, const char *name);

/* The same, made when it is not there, for the payer (principal_payer; 0: nobody's). NULL with *e
 * ("too-many-rooms", "bad-field"). */
struct channel *channel_room(struct rooms *rooms, const char *name, uint32_t payer, struct error *e);

/* -1 with *e ("bad-field") when no room can have that name. */
int channel_check_name(const char *name, struct error *e);

/* Speaks the request to who is in the room, under the number *utterance (0: it is kept until somebody is
 * there). The answer, as HTTP has it; NULL with *e: "busy", "queue-full". */
json_t *room_speak(struct rooms *rooms, const char *room, const struct speech_request *request,
                   uint32_t *utterance, struct error *e);

#endif
