/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sockets that are listened on, and whom they let in. */
#ifndef FACCIA_NET_LISTENER_H
#define FACCIA_NET_LISTENER_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>

struct net;

/* Listens. -1 with *e: "bad-field" (an address that others can reach, which is not allowed), "listen". */
int listeners_open(struct net *net, struct error *e);
void listeners_close(struct net *net);

/* Where the socket of that number, from 0, listens. False: there is none. */
bool listeners_address(const struct net *net, size_t number, struct buf *out);

/* From time to time. */
void listeners_look(struct net *net);

#endif
