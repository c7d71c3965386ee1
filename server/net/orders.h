/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What somebody asks of a room whose home another daemon is, or may be. */
#ifndef FACCIA_NET_ORDERS_H
#define FACCIA_NET_ORDERS_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct net;
struct order;

/* The answer as that of HTTP: its status, and the message, borrowed. Comes once. */
typedef void (*order_done)(void *ctx, unsigned status, const json_t *answer);

/* Whether what is asked of that room has to be ordered; when not, the room's home is here, or it is this
 * daemon's alone. */
bool order_needed(const struct net *net, const char *room);

/* Orders it; drops what is asked (order_act.h). done may be called at once: then NULL is returned. */
struct order *order_give(struct net *net, const char *room, json_t *asked, order_done done, void *ctx);

/* No answer is wanted any more. */
void order_forget(struct order *order);

#endif
