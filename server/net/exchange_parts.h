/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of one HTTP exchange share. */
#ifndef FACCIA_NET_EXCHANGE_PARTS_H
#define FACCIA_NET_EXCHANGE_PARTS_H

#include "server/net/internal.h"

struct exchange {
    struct net *net;
    struct lws *wsi;
    struct exchange *next, **self; /* in the net's list */
    struct exchange_work work;
    const uint8_t *body; /* what is left of a body of known length */
    size_t body_size;
    void *owned;       /* that body's memory, if it is the exchange's */
    struct buf queue;  /* of an answer in chunks: what waits */
    uint64_t progress; /* loop time when bytes left last, or began to wait, ms */
    uint64_t beat;     /* loop time of the last beat, ms */
    bool cut;          /* the connection is */
    bool chunked, complete, answered, done;
    bool shared; /* any page may have the answer */
    struct guest guest;
};

/* Loop time, ms. */
uint64_t exchange_now(const struct exchange *exchange);

#endif
