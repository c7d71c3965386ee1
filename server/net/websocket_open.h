/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The handshake of a WebSocket (RFC 6455, 4.2). */
#ifndef FACCIA_NET_WEBSOCKET_OPEN_H
#define FACCIA_NET_WEBSOCKET_OPEN_H

#include <stdbool.h>

struct exchange;

/* Does the request ask for one? Then it has been answered, and when it has got one, the connection's HTTP is
 * no more: its session is the caller's to free. */
bool websocket_asked(struct exchange *exchange);

#endif
