/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of rooms, the speech held for empty rooms, and the sharing of rooms between daemons. */
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
    unsigned queue;         /* utterances waiting on one stream */
    unsigned rooms;         /* rooms with followers */
    unsigned address_rooms; /* rooms with followers that one address or subject created; 0: no limit */
    unsigned send_bytes;    /* unsent bytes at which a client's own stream waits for its listener */
    unsigned hold_seconds;  /* s to hold speech to an empty room for a listener; 0: not held */
};

/* Runs a command for a room that this daemon leads, sent by another daemon or by one of its own clients.
 * Returns the answer in HTTP's form, a new reference, and its status. The command is an object: `type`;
 * `request`, what to speak (request_to_json); `message`, the client's message for the other types; `by`,
 * the name of the sender; `quota_key` and `connection` (speech_request.h). remote: the daemon that sent it,
 * 0: this daemon. number: the command's number in the cluster. `utterance` of the answer, which is not in
 * HTTP's answer, is the number of the utterance to be spoken. */
typedef json_t *rooms_run(void *ctx, const char *room, const json_t *command, uint64_t remote,
                          uint64_t number, unsigned *status);

/* pipeline is borrowed and must outlive the rooms. */
struct rooms *rooms_open(const struct pipeline *pipeline, const struct room_limits *limits, rooms_run *run,
                         void *ctx);
void rooms_change(struct rooms *rooms, const struct room_limits *limits);

/* Records the sessions of studies in a folder (session.h), which must outlive the rooms. */
void rooms_record(struct rooms *rooms, const char *folder);

/* Shares rooms with other daemons until rooms_unshare, which must come before the bus is closed. */
void rooms_share(struct rooms *rooms, struct bus *bus);
void rooms_unshare(struct rooms *rooms);

void rooms_tick(struct rooms *rooms); /* call once a second */
void rooms_close(struct rooms *rooms);
void rooms_free(struct rooms *rooms);

/* The first room, or NULL; channel_next returns the others. */
struct channel *rooms_first(const struct rooms *rooms);

/* Finds a room by name. Returns NULL if it does not exist. */
struct channel *channel_find(const struct rooms *rooms, const char *name);
/* The same; NULL also for a room without followers. */
struct channel *channel_occupied(const struct rooms *rooms, const char *name);

/* Finds or creates a room; a new room counts against the quota key (principal_quota_key; 0: no quota key).
 * Returns NULL with *e ("too-many-rooms", "bad-field"). */
struct channel *channel_room(struct rooms *rooms, const char *name, uint32_t quota_key, struct error *e);

/* Validates a room name. Returns -1 with *e ("bad-field"). */
int channel_check_name(const char *name, struct error *e);

/* Speaks the request to the room. *utterance is the number of the utterance, or 0 when the request is held
 * until the room has a listener. Returns the answer in HTTP's form; NULL with *e: "busy", "queue-full". */
json_t *room_speak(struct rooms *rooms, const char *room, const struct speech_request *request,
                   uint32_t *utterance, struct error *e);

#endif
