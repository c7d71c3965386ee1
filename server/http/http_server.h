/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The HTTP server: listens, reads requests, carries their answers and WebSockets, and looks after what takes
 * too long. It knows HTTP and WebSocket; what a request means is its owner's affair (struct http_calls). */
#ifndef FACCIA_HTTP_HTTP_SERVER_H
#define FACCIA_HTTP_HTTP_SERVER_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

struct connection;
struct exchange;
struct http_request;
struct http_server;
struct metrics;
struct quota;
struct transport_tls;

struct http_options {
    const char *host;      /* address, name or interface to listen on, "*" = all */
    unsigned port;         /* 0 = any free one */
    bool remote;           /* allow a host that is not loopback, which needs tokens, too */
    bool tokens;           /* are demanded */
    const int *listen_fds; /* sockets that listen already, in place of host and port */
    unsigned listen_count;
    const struct transport_tls *tls; /* NULL: none */
    unsigned hsts;                   /* seconds of Strict-Transport-Security; 0 = none */
    unsigned connections;            /* open connections */
    unsigned connections_above;   /* that are told so; those that ask for /healthz or /metrics are served */
    unsigned address_connections; /* of one address, or one token's subject; 0 = no limit of its own */
    unsigned message_bytes;       /* longest message of a WebSocket */
    unsigned send_bytes;          /* unsent bytes at which a WebSocket's client is not read any more */
    unsigned send_bytes_max;      /* unsent bytes at which it is closed as too slow */
    unsigned stall_seconds;       /* a client that takes nothing for so long while bytes wait is closed */
    unsigned ping_seconds;        /* a WebSocket silent for so long is pinged, and closed a third later */
};

/* What the owner of the server does. */
struct http_calls {
    /* A request's head has come: answers it (exchange.h), at once or later. */
    void (*serve)(void *ctx, struct exchange *x);

    /* A request asks for a WebSocket: websocket_accept, or an answer. */
    void (*upgrade)(void *ctx, struct exchange *x);

    /* May the page that the request comes from see the answer? */
    bool (*origin_allowed)(void *ctx, const struct http_request *request);

    /* Once a second. */
    void (*tick)(void *ctx);
};

/* Listens at once. The quota counts connections by their keys; it outlives the server, as do the strings of
 * the options. NULL with *e: "bad-field" (a host that others can reach, which is not allowed), "listen", or
 * as transport_open. */
struct http_server *http_server_open(uv_loop_t *loop, struct metrics *metrics, struct quota *quota,
                                     const struct http_options *options, const struct http_calls *calls,
                                     void *ctx, struct error *e);

/* Takes the limits of the options, and reads the certificate anew. -1 with *e: the certificate stays as it
 * was. */
int http_server_change(struct http_server *server, const struct http_options *options, struct error *e);

/* Keeps no connection alive after its answer. */
void http_server_drain(struct http_server *server);

/* Closes all connections; then run the loop until it is empty and free the server. NULL is fine. */
void http_server_close(struct http_server *server);
void http_server_free(struct http_server *server);

/* Appends the address of the socket of that number, from 0, as in "http://[::1]:8080/". False: there is none.
 */
bool http_server_address(const struct http_server *server, size_t number, struct buf *out);

bool http_server_is_local(const struct http_server *server);        /* listens on loopback addresses only */
unsigned http_server_connections(const struct http_server *server); /* that are open */
unsigned http_server_pending(const struct http_server *server);     /* answers that are being made */

/* A connection's number among all that there were, never 0; and what its address is counted by: "a ADDRESS".
 */
uint32_t connection_number(const struct connection *connection);
const char *connection_address(const struct connection *connection);

/* Counts the connection under another key from now on. False, and nothing is changed, when that key has too
 * many open. */
bool connection_count(struct connection *connection, const char *key);

#endif
