/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The HTTP server: listens, parses requests, carries responses and WebSockets, and enforces timeouts. It
 * knows HTTP and WebSocket only; its owner gives requests their meaning (struct http_calls). */
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
    const char *host;      /* address, name or interface to listen on; "*": all */
    unsigned port;         /* 0: any free port */
    bool remote;           /* allow a host that is not loopback, which requires tokens as well */
    bool tokens;           /* tokens are required */
    const int *listen_fds; /* sockets that listen already, instead of host and port */
    unsigned listen_count;
    const struct transport_tls *tls; /* NULL: none */
    unsigned hsts;                   /* seconds of Strict-Transport-Security; 0: none */
    unsigned connections;            /* most open connections */
    unsigned connections_above;   /* connections accepted above that limit: they get only an error, /healthz
                                     and /metrics */
    unsigned address_connections; /* per address or token subject; 0: no separate limit */
    unsigned message_bytes;       /* longest WebSocket message */
    unsigned send_bytes;          /* unsent bytes above which a WebSocket is not read */
    unsigned send_bytes_max;      /* unsent bytes above which it is closed as too slow */
    unsigned stall_seconds;       /* closes a client that takes no bytes for this long while some wait */
    unsigned ping_seconds;        /* pings a WebSocket after this silence, and closes it a third later */
};

/* Callbacks of the server's owner. */
struct http_calls {
    /* Answers a request (exchange.h), at once or later. Called when its head is complete. */
    void (*serve)(void *ctx, struct exchange *x);

    /* Handles a request for a WebSocket: by websocket_accept, or with a response. */
    void (*upgrade)(void *ctx, struct exchange *x);

    /* Returns whether the page that sent the request may read the response. */
    bool (*origin_allowed)(void *ctx, const struct http_request *request);

    /* Called once a second. */
    void (*tick)(void *ctx);
};

/* Starts listening at once. The quota counts connections by their keys; it and the strings of the options
 * must outlive the server. NULL with *e: "bad-field" (other machines can reach the host, and that is not
 * allowed), "listen", or as transport_open. */
struct http_server *http_server_open(uv_loop_t *loop, struct metrics *metrics, struct quota *quota,
                                     const struct http_options *options, const struct http_calls *calls,
                                     void *ctx, struct error *e);

/* Applies the limits of the options and reloads the certificate. -1 with *e: the certificate is unchanged. */
int http_server_change(struct http_server *server, const struct http_options *options, struct error *e);

/* Closes each connection after its current response. */
void http_server_drain(struct http_server *server);

/* Closes all connections. Then run the loop until it is empty and free the server. NULL is allowed. */
void http_server_close(struct http_server *server);
void http_server_free(struct http_server *server);

/* Appends the URL of listening socket `number` (from 0), such as "http://[::1]:8080/". False if `number` is
 * out of range. */
bool http_server_address(const struct http_server *server, size_t number, struct buf *out);

/* The same of addresses at which other machines may reach the server. */
bool http_server_outside_address(const struct http_server *server, size_t number, struct buf *out);

bool http_server_is_local(const struct http_server *server);        /* listens on loopback addresses only */
unsigned http_server_connections(const struct http_server *server); /* open connections */
unsigned http_server_pending(const struct http_server *server);     /* responses in progress */

/* The connection's number since the server's start, never 0; and the quota key of its address: "a
 * ADDRESS". */
uint32_t connection_number(const struct connection *connection);
const char *connection_address(const struct connection *connection);

/* Counts the connection under another quota key. Returns false, changing nothing, if that key has too many
 * open. */
bool connection_count(struct connection *connection, const char *key);

#endif
