/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connection to a broker (MQTT 3.1.1, libmosquitto). Its thread is hidden: callbacks run on the loop.
 * Reconnects and resumes the session. All messages have QoS 1. */
#ifndef FACCIA_BRIDGES_MQTT_LINK_H
#define FACCIA_BRIDGES_MQTT_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

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
