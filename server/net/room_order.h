/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an HTTP request asks of a room in which another daemon speaks: the request is answered when that one
 * has. */
#ifndef FACCIA_NET_ROOM_ORDER_H
#define FACCIA_NET_ROOM_ORDER_H

#include <jansson.h>
#include <stdbool.h>

struct exchange;
struct order;

/* In what works on the exchange, which calls room_order_forget when it is freed. */
struct room_order {
    struct exchange *x;
    struct order *order; /* that is waited for, or NULL */
};

bool room_order_needed(const struct exchange *x);

/* Drops the order. Returns 0, for what answers. */
int room_order_give(struct room_order *waits, struct exchange *x, json_t *order);
void room_order_forget(struct room_order *waits);

/* The same for a request without a body that was expected. */
int room_order(struct exchange *x, json_t *order);

#endif
