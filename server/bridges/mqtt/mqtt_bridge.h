/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between a broker and the rooms of a daemon; protocol/mqtt.md lists the topics. Ids of requests prevent
 * duplicates, and let the bridge report how each ended. */
#ifndef FACCIA_BRIDGES_MQTT_BRIDGE_H
#define FACCIA_BRIDGES_MQTT_BRIDGE_H

#include "server/bridges/remote.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

enum { SAID_ID = 65, SAID_KEPT = 256 };

struct said {
    char id[SAID_ID];
    char site[SAID_ID], session[SAID_ID]; /* of Hermes; empty: none */
    bool hermes, open;                    /* its end is expected */
};

/* Of a room; zeroed is empty. The oldest are forgotten. */
struct said_ids {
    struct said all[SAID_KEPT];
    uint32_t next;
};

enum { BRIDGE_ROOMS = 32, BRIDGE_TOPIC = 256 };

struct bridge_room {
    struct bridge *bridge;
    char *name;
    struct follow *follow;
    struct said_ids said;
    char state[16], speaking_id[SAID_ID];  /* state of the assistant, and the utterance being spoken */
    char *words, *voice, *mood, *head;     /* NULL: none */
    bool speaks, muted, absent, available; /* absent: nobody is watching the room */
};

struct bridge {
    uv_loop_t *loop;
    struct mqtt_link *link;
    struct remote *remote;
    const char *base;      /* topic prefix */
    const char *discovery; /* Home Assistant's prefix; NULL: off */
    const char *device;    /* prefix of device ids */
    struct bridge_room rooms[BRIDGE_ROOMS];
    unsigned room_count, asking; /* asking: number of waiting requests */
    struct asking *asked;
    json_t *voices, *moods, *heads; /* names; NULL: not known yet */
};

/* Set bridge->link and the other members first; names are copied. */
void bridge_add_room(struct bridge *bridge, const char *name);
/* Requests voices and moods, and follows the rooms. */
void bridge_begin(struct bridge *bridge);
void bridge_end(struct bridge *bridge);
extern const struct mqtt_calls bridge_calls;

extern const struct remote_events room_events_calls;

/* Cancels waiting requests; the remote is gone. */
void commands_drop(struct bridge *bridge);

/* Connection to a broker (MQTT 3.1.1, libmosquitto). Its thread is hidden: callbacks run on the loop.
 * Reconnects and resumes the session. All messages have QoS 1. */

struct mqtt_options {
    const char *host;
    int port;
    const char *client;                    /* client id */
    const char *user, *password, *ca_file; /* may be NULL; ca_file enables TLS */
    const char *will;                      /* topic that is "online" while connected, else "offline" */
};

struct mqtt_calls {
    void (*connected)(void *ctx);
    /* payload is followed by a NUL that size does not count; NULL: longer than MQTT_PAYLOAD_MOST. */
    void (*message)(void *ctx, const char *topic, const char *payload, size_t size, bool retained);
};

struct mqtt_link;

enum { MQTT_PAYLOAD_MOST = 1 << 20 /* bytes */ };

/* NULL after a message. */
struct mqtt_link *mqtt_link_new(uv_loop_t *loop, const struct mqtt_options *options,
                                const struct mqtt_calls *calls, void *ctx);
/* Disconnects. Run the loop until it is empty. */
void mqtt_link_free(struct mqtt_link *link);

void mqtt_subscribe(struct mqtt_link *link, const char *topic);

/* While disconnected, drops retained messages (they are published again later), and queues up to 100
 * others. */
void mqtt_publish(struct mqtt_link *link, const char *topic, const char *payload, bool retained);

#endif
