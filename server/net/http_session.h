/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP on one connection: its requests, one after the other, and how long they may take. */
#ifndef FACCIA_NET_HTTP_SESSION_H
#define FACCIA_NET_HTTP_SESSION_H

#include "server/net/connection.h"

/* HTTP is spoken over the connection from now on. */
void http_session_open(struct connection *connection);

/* It has answered, and waits for another request. */
bool http_session_is_idle(const struct connection *connection);

#endif
