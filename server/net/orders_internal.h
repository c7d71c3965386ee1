/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An order on its way, and afterwards, while what it asked for waits or is spoken at the home. */
#ifndef FACCIA_NET_ORDERS_INTERNAL_H
#define FACCIA_NET_ORDERS_INTERNAL_H

#include "server/net/homes_internal.h"
#include "server/net/orders.h"

struct order {
    struct order *prev, *next;
    struct homes *homes;
    struct channel *channel; /* kept until it is taken */
    uint64_t number;
    uint64_t until; /* loop time */
    json_t *asked;
    bool sent;
    bool again;         /* what it asks for was lost once */
    uint32_t utterance; /* that the home has taken; 0: not yet */
    unsigned tries;
    order_done done; /* NULL: nobody waits */
    void *ctx;
};

/* It is gone. */
void order_free(struct order *order);

/* By which all daemons know it (home_order). */
uint64_t order_number(const struct order *order);

/* Is what it asked for heard here, or has its end been? Also when nobody has answered. */
bool order_is_spoken(const struct order *order);
bool order_has_ended(const struct order *order);

/* Whether what it asks for is spoken again when it is lost. */
bool order_is_again(const struct order *order);

/* Tells who follows here that it has failed. */
void order_tell_failed(const struct order *order, const struct error *e);

#endif
