/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A broker (MQTT 3.1.1, libmosquitto), whose thread stays hidden: calls come back on the loop. A lost
 * connection is made again, with the session that the broker has kept. Everything goes with QoS 1. */
#ifndef FACCIA_DOORS_MQTT_LINK_H
#define FACCIA_DOORS_MQTT_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct mqtt_options {
    const char *host;
    int port;
    const char *client;                    /* the session's name */
    const char *user, *password, *ca_file; /* or NULL; with ca_file by TLS */
    const char
        *will; /* topic that says "offline" when the connection breaks, and "online" while it is there */
};

struct mqtt_calls {
    void (*connected)(void *ctx);
    /* payload ends with a NUL that size does not count; NULL: it is longer than MQTT_PAYLOAD_MOST. */
    void (*message)(void *ctx, const char *topic, const char *payload, size_t size, bool retained);
};

struct mqtt_link;

enum { MQTT_PAYLOAD_MOST = 1 << 20 /* bytes */ };

/* NULL after a message. */
struct mqtt_link *mqtt_link_new(uv_loop_t *loop, const struct mqtt_options *options,
                                const struct mqtt_calls *calls, void *ctx);
/* Says goodbye. The loop has to run until it has nothing to do. */
void mqtt_link_free(struct mqtt_link *link);

void mqtt_subscribe(struct mqtt_link *link, const char *topic);

/* What is retained waits for nobody: while there is no broker it is left out (it is said anew when there is
 * one); of the rest up to 100 wait. */
void mqtt_publish(struct mqtt_link *link, const char *topic, const char *payload, bool retained);

#endif
