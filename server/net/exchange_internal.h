/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of one HTTP exchange share. */
#ifndef FACCIA_NET_EXCHANGE_INTERNAL_H
#define FACCIA_NET_EXCHANGE_INTERNAL_H

#include "server/base/etag.h"
#include "server/net/connection.h"
#include "server/net/net_internal.h"

enum { WARNINGS_MOST = 8 };

struct exchange {
    struct net *net;
    const struct http_request *request;
    struct connection *connection;
    const struct exchange_session *session;
    struct exchange_work work;
    struct buf request_body; /* what has come of it */
    size_t body_most;        /* 0 = none is expected */
    enum error_code body_too_long;
    struct buf queue;    /* of the answer: what waits */
    const uint8_t *body; /* what is to follow, and lives as long as the net */
    size_t body_size;
    uint64_t last_keepalive; /* loop time of the last keepalive, ms */
    char etag[ETAG_BYTES];   /* of the answer; "": none */
    bool chunked;            /* the answer's length is not known */
    bool framed;             /* and it is told in chunks, not by the connection's end */
    bool complete, answered, done, persists;
    bool shared;  /* any page may have the answer */
    bool refused; /* the page is; it may see that there is an answer, to tell its reader why */
    struct principal principal;
    struct error *warnings;
    size_t warning_count;
};

/* Sends what waits, as far as it goes. */
void exchange_flush(struct exchange *exchange);

#endif
