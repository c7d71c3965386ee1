/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A TCP connection that carries events of the Wyoming protocol, on a libuv loop. */
#ifndef FACCIA_BRIDGES_SATELLITE_WYOMING_LINK_H
#define FACCIA_BRIDGES_SATELLITE_WYOMING_LINK_H

#include "server/base/json/wyoming_event.h"
#include <uv.h>

struct wyoming_link;

/* Callbacks may close the link. */
struct wyoming_link_calls {
    void (*event)(void *ctx, const struct wyoming_event *event);
    void (*ended)(void *ctx, const char *why); /* last call; not after wyoming_link_close */
};

/* Accepts a waiting connection. NULL: it is gone already. */
struct wyoming_link *wyoming_link_accept(uv_stream_t *listener, const struct wyoming_link_calls *calls,
                                         void *ctx);

/* Connects. Events may be sent at once; they wait for the connection. address: HOST:PORT, or [HOST]:PORT;
 * see wyoming_address_check. */
struct wyoming_link *wyoming_link_connect(uv_loop_t *loop, const char *address,
                                          const struct wyoming_link_calls *calls, void *ctx);
bool wyoming_address_check(const char *address);

/* Sends an event; data is released. A peer that leaves too much unread is disconnected. */
void wyoming_link_tell(struct wyoming_link *link, const char *type, json_t *data, const void *payload,
                       size_t size);

/* Sends what waits, then hangs up. No callback follows. */
void wyoming_link_close(struct wyoming_link *link);

#endif
