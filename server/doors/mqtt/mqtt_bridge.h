/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between a broker and the rooms of a daemon. The topics stand in protocol/mqtt.md. */
#ifndef FACCIA_DOORS_MQTT_BRIDGE_H
#define FACCIA_DOORS_MQTT_BRIDGE_H

#include "server/doors/mqtt/mqtt_link.h"
#include "server/doors/mqtt/mqtt_said.h"
#include "server/doors/remote.h"

enum { BRIDGE_ROOMS = 32, BRIDGE_TOPIC = 256 };

struct bridge_room {
    struct bridge *bridge;
    char *name;
    struct follow *follow;
    struct said_ids said;
    char state[16], speaking_id[SAID_ID];  /* what the assistant does, and what is spoken */
    char *words, *voice, *mood;            /* NULL: none */
    bool speaks, muted, absent, available; /* absent: whoever looks at the face has gone */
};

struct bridge {
    uv_loop_t *loop;
    struct mqtt_link *link;
    struct remote *remote;
    const char *base;      /* of the topics */
    const char *discovery; /* of Home Assistant; NULL: none */
    const char *device;    /* what ids of devices begin with */
    struct bridge_room rooms[BRIDGE_ROOMS];
    unsigned room_count, asking; /* requests that wait for the daemon: so many */
    struct asking *asked;
    json_t *voices, *moods; /* names; NULL: not known yet */
};

/* bridge->link and the rest of it are set; room names are copied. */
void bridge_add_room(struct bridge *bridge, const char *name);
/* Asks for voices and moods and follows the rooms. */
void bridge_begin(struct bridge *bridge);
void bridge_end(struct bridge *bridge);
extern const struct mqtt_calls bridge_calls;

/* mqtt_room.c */

/* Publishes below the room's topic. */
void room_publish(struct bridge_room *room, const char *topic, const char *payload, bool retained);
void room_publish_json(struct bridge_room *room, const char *topic, json_t *payload, bool retained);
/* All that is retained. */
void room_publish_all(struct bridge_room *room);
/* The mix that was asked for: its names, with their intensities. */
void room_take_mood(struct bridge_room *room, const json_t *mix);
/* What was sent to one of its topics is not done, and why: told in `said` if it was to be said, else in
 * `refused`. */
void room_refuse(struct bridge_room *room, const char *command, const char *why);
/* Is there such a voice? As long as none are known, any. */
bool bridge_has_voice(const struct bridge *bridge, const char *voice);
/* How what was asked for ended. */
void room_tell(struct bridge_room *room, const char *id, const char *reason, const char *why);
extern const struct remote_events room_events_calls;

/* mqtt_commands.c */

/* One of the room's topics: "say". */
void room_command(struct bridge_room *room, const char *command, const char *payload, size_t size);
/* Its voice is none of the daemon's (any more): the daemon's own speaks again. */
void room_drop_voice(struct bridge_room *room);
/* Requests that wait are given up: the remote is gone. */
void commands_drop(struct bridge *bridge);
/* hermes/tts/say of Rhasspy. */
void hermes_say(struct bridge *bridge, const char *payload, size_t size);

/* mqtt_discovery.c: tells Home Assistant of the room's device. */
void room_discover(struct bridge_room *room);

#endif
