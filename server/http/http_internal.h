/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the HTTP server. */
#ifndef FACCIA_HTTP_HTTP_INTERNAL_H
#define FACCIA_HTTP_HTTP_INTERNAL_H

#include "server/base/buf.h"
#include "server/base/etag.h"
#include "server/http/exchange.h"
#include "server/http/http_server.h"
#include "server/http/transport.h"

#include <stdbool.h>
#include <sys/socket.h>

struct http_server {
    struct http_options options;
    const struct http_calls *calls;
    void *ctx; /* passed to the calls */
    uv_loop_t *loop;
    struct metrics *metrics;
    struct quota *quota;
    struct transport *transport;
    struct listeners *listeners;
    struct connection *open; /* all connections */
    struct connection *due;  /* see connection_later */
    unsigned connections;
    unsigned pending;  /* responses in progress */
    uint32_t numbered; /* connection numbers assigned; wraps around */
    bool local;        /* listens on loopback addresses only */
    bool draining;
    uv_timer_t *timer; /* one for all connections; NULL: none */
    uv_idle_t *idle;   /* NULL: none */
};

/* listener.c */

/* -1 with *e: "bad-field" (other machines can reach the address, and that is not allowed), "listen". */
int listeners_open(struct http_server *server, struct error *e);
void listeners_close(struct http_server *server);
bool listeners_address(const struct http_server *server, size_t number, struct buf *out);
bool listeners_outside_address(const struct http_server *server, size_t number, struct buf *out);

/* Call when a connection has gone: its descriptor is free and accepting can resume. reserve: it may be one
 * of the reserve. */
void listeners_freed(struct http_server *server, bool reserve);

/* connection.c: one TCP or Unix-domain connection. A protocol handles its bytes: HTTP first, later perhaps
 * WebSocket. */

/* Callbacks of a protocol. All except read, sent and free may be NULL. */
struct connection_protocol {
    void (*read)(struct connection *connection, const char *bytes, size_t size); /* bytes have arrived */
    void (*eof)(struct connection *connection);   /* the peer sends nothing more; NULL: closes it */
    void (*sent)(struct connection *connection);  /* everything has been sent: there is room for more */
    void (*go_on)(struct connection *connection); /* see connection_later */
    void (*look)(struct connection *connection);  /* called once a second */
    void (*free)(struct connection *connection);  /* frees the state, with the connection or earlier */
};

struct connection {
    struct http_server *server;
    struct connection *next, **self;            /* in the server's list */
    struct connection *next_due;                /* in the list of connection_later */
    const struct connection_protocol *protocol; /* NULL: none, or none any more */
    struct http_session *http;                  /* state of the protocol: one of these two */
    struct websocket *websocket;
    const char *name; /* for the log */
    uint32_t number;  /* number of the connection since the start; never 0 */
    struct peer *peer;
    char *key;         /* quota key: "a ADDRESS" or "s SUBJECT" */
    char *address_key; /* quota key of the address */
    uint64_t progress; /* loop time when bytes were last sent, or began to wait, ms */
    uint64_t end_by;   /* loop time of the unconditional close, ms; 0: none */
    size_t unsent;     /* at the last check */
    bool paused, due;  /* paused: reading is off */
    bool finished;     /* nothing more is sent, and input is discarded */
    bool closing;
    bool surplus; /* above the connection limit: gets only that error, except for /healthz and /metrics */
    bool crowded; /* its address has too many connections */
    bool local;   /* the peer is on this machine */
    bool borrows_reserve; /* uses a descriptor of the reserve */
};

/* Callbacks for the transport. */
extern const struct peer_calls connection_calls;

/* Takes ownership of the connected socket. Reads nothing before connection_use. */
struct connection *connection_open(struct http_server *server, int fd, const struct sockaddr_storage *peer);

/* Switches to a protocol. The caller frees the state of the previous one. */
void connection_use(struct connection *connection, const struct connection_protocol *protocol);

/* Sends as many bytes as there is room for, and returns how many. If not all fit, the protocol's `sent` is
 * called once there is room again. A closing connection accepts all bytes and discards them. */
size_t connection_send(struct connection *connection, const void *bytes, size_t size);
size_t connection_send_parts(struct connection *connection, const struct iovec *parts, size_t count);

size_t connection_unsent(const struct connection *connection); /* bytes not yet sent */
void connection_read(struct connection *connection, bool on);

/* Returns whether the connection uses TLS. Known once bytes have arrived. */
bool connection_secure(const struct connection *connection);

/* Schedules the protocol's go_on, for callers that are inside the building of a response. */
void connection_later(struct connection *connection);

/* Ends the sending side and waits briefly for the peer to close. An immediate close would let the kernel
 * discard bytes in flight when the peer sends more. */
void connection_finish(struct connection *connection);

/* Closes the connection, which is freed soon after with all that belongs to it. */
void connection_close(struct connection *connection);
void connections_close(struct http_server *server);

uint64_t connection_now(const struct connection *connection); /* loop time, ms */

/* http_session.c */

/* Starts HTTP on the connection. */
void http_session_open(struct connection *connection);

/* Returns whether it has answered and waits for another request. */
bool http_session_is_idle(const struct connection *connection);

/* exchange.c */

/* Callbacks of the session that received the request, used while it is answered. */
struct exchange_session {
    bool (*persists)(const struct connection *connection); /* can it stay open after a response given now? */
    void (*answered)(struct connection *connection);       /* the whole response has been sent */
};

struct exchange {
    struct http_server *server;
    const struct http_request *request;
    struct connection *connection;
    const struct exchange_session *session;
    struct exchange_work work;
    void *attached;          /* data of the owner, by malloc */
    struct buf request_body; /* bytes received so far */
    size_t body_most;        /* bytes; 0: no body is expected */
    enum error_code body_too_long;
    struct buf headers;  /* additional headers of the response */
    struct buf queue;    /* of the response: bytes not yet sent */
    const uint8_t *body; /* sent after the queue; outlives the exchange */
    size_t body_size;
    uint64_t last_keepalive; /* loop time, ms */
    char *const *embed;      /* origins whose pages may frame the response; or NULL */
    char etag[ETAG_BYTES];   /* of the response; "": none */
    bool chunked;            /* the length of the response is not known */
    bool framed;             /* it is sent in chunks, not ended by closing the connection */
    bool complete, answered, done, persists;
    bool shared;  /* any page may read the response */
    bool refused; /* the page is refused, but may read the response, to tell its user why */
    struct error *warnings;
    size_t warning_count;
};

struct exchange *exchange_open(struct http_server *server, const struct http_request *request,
                               const struct exchange_session *session);
void exchange_close(struct exchange *x);
void exchange_sent(struct exchange *x);                   /* bytes were sent */
bool exchange_done(const struct exchange *x);             /* fully sent: close it */
bool exchange_persists(const struct exchange *x);         /* another request may follow */
bool exchange_ends_with_client(const struct exchange *x); /* cancelled when the client closes its side */
void exchange_look(struct exchange *x);                   /* called once a second */
void exchange_take_body(struct exchange *x, const void *data, size_t size); /* part of the body */
bool exchange_streams_body(const struct exchange *x);                       /* its body may take any time */

/* Resolves a host name or an interface to the addresses to listen on, and lists the addresses at which other
 * machines reach a socket. */

struct listen_address {
    struct sockaddr_storage at; /* with port 0, until listen_address_set_port */
    socklen_t size;
};

struct listen_addresses {
    struct listen_address *list;
    size_t count, cap;
};

/* host: an address, with or without brackets; a name; an interface; "*": all of IPv4 and IPv6. IPv4 comes
 * first. count is 0 if nothing is found. The caller frees the list. */
void listen_addresses_find(struct listen_addresses *found, const char *host);

/* Appends the addresses at which other machines may reach a socket of this address, with its port: the
 * address itself, or, if it stands for all, those of the interfaces that are up. Leaves out loopback and
 * link-local addresses. */
void listen_addresses_outside(struct listen_addresses *found, const struct sockaddr_storage *address);

/* Returns whether only this machine can reach the address. */
bool listen_address_is_local(const struct sockaddr_storage *address);

void listen_address_set_port(struct sockaddr_storage *address, int port);
int listen_address_port(const struct sockaddr_storage *address); /* 0: it has none */

/* Appends "http://127.0.0.1:8080/", "http://[::1]:8080/" or "unix:/run/faccia". */
void listen_address_write(const struct sockaddr_storage *address, bool tls, struct buf *out);

#endif
