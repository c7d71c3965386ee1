/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the HTTP server share. */
#ifndef FACCIA_HTTP_HTTP_INTERNAL_H
#define FACCIA_HTTP_HTTP_INTERNAL_H

#include "server/base/etag.h"
#include "server/http/exchange.h"
#include "server/http/http_server.h"
#include "server/http/transport.h"
#include <sys/socket.h>

struct http_server {
    struct http_options options;
    const struct http_calls *calls;
    void *ctx; /* of the calls */
    uv_loop_t *loop;
    struct metrics *metrics;
    struct quota *quota;
    struct transport *transport;
    struct listeners *listeners;
    struct connection *open; /* all connections */
    struct connection *due;  /* see connection_later */
    unsigned connections;
    unsigned pending;  /* answers that are being made */
    uint32_t numbered; /* connections so far; wraps around */
    bool local;        /* listens on loopback addresses only */
    bool draining;
    uv_timer_t *timer; /* over all connections; NULL: none */
    uv_idle_t *idle;   /* NULL: none */
};

/* listener.c */

/* -1 with *e: "bad-field" (an address that others can reach, which is not allowed), "listen". */
int listeners_open(struct http_server *server, struct error *e);
void listeners_close(struct http_server *server);
bool listeners_address(const struct http_server *server, size_t number, struct buf *out);

/* A connection has gone: a descriptor, perhaps one of those in reserve, is free. */
void listeners_freed(struct http_server *server, bool reserve);

/* connection.c: one TCP connection, or one of a Unix socket. What is spoken over it is a protocol's: HTTP
 * first, and then perhaps WebSocket. */

/* What a protocol does. All but read, sent and free may be NULL. */
struct connection_protocol {
    void (*read)(struct connection *connection, const char *bytes, size_t size); /* bytes have come */
    void (*eof)(struct connection *connection);   /* no more will come; NULL: it is closed */
    void (*sent)(struct connection *connection);  /* all bytes have left: there is room for others */
    void (*go_on)(struct connection *connection); /* what connection_later is about */
    void (*look)(struct connection *connection);  /* once a second */
    void (*free)(struct connection *connection);  /* it goes with the connection, or before */
};

struct connection {
    struct http_server *server;
    struct connection *next, **self;            /* in the server's list */
    struct connection *next_due;                /* among those that connection_later is about */
    const struct connection_protocol *protocol; /* NULL = none (any more) */
    struct http_session *http;                  /* its: one of these two */
    struct websocket *websocket;
    const char *name; /* in the log */
    uint32_t number;  /* among all that there were; never 0 */
    struct peer *peer;
    char *key;         /* what it is counted by in the quota: "a ADDRESS" or "s SUBJECT" */
    char *address_key; /* the former */
    uint64_t progress; /* loop time when bytes left last, or began to wait, ms */
    uint64_t end_by;   /* loop time at which it is closed, whatever comes; 0 = never */
    size_t unsent;     /* when that was looked at last */
    bool paused, due;  /* paused: it is not read */
    bool finished;     /* nothing more is sent, and what comes is dropped */
    bool closing;
    bool surplus;         /* above a limit: is told so, and has no more than that */
    bool crowded;         /* its address has too many open */
    bool local;           /* its other end is on this machine */
    bool borrows_reserve; /* lives on a descriptor that is held in reserve */
};

/* What connections are told by their transport. */
extern const struct peer_calls connection_calls;

/* Takes the connected socket. Nothing comes of it before connection_use. */
struct connection *connection_open(struct http_server *server, int fd, const struct sockaddr_storage *peer);

/* Speaks that from now on; what was spoken before has been freed. */
void connection_use(struct connection *connection, const struct connection_protocol *protocol);

/* Takes bytes to be sent, as many as there is room for, and returns how many. When that is not all, the
 * protocol is told (`sent`) once there is room again. Of one that closes all is taken, and lost. */
size_t connection_send(struct connection *connection, const void *bytes, size_t size);
size_t connection_send_parts(struct connection *connection, const struct iovec *parts, size_t count);

size_t connection_unsent(const struct connection *connection); /* bytes that have not left */
void connection_read(struct connection *connection, bool on);

/* Is it carried by TLS? Known once bytes have come. */
bool connection_secure(const struct connection *connection);

/* Lets the protocol go on, soon: for what is done from within an answer's own making. */
void connection_later(struct connection *connection);

/* Says that nothing more comes, and waits, not for long, for the other end to close: what it still sends
 * would make the kernel take back what is on its way to it. */
void connection_finish(struct connection *connection);

/* It is gone soon after, with what belongs to it. */
void connection_close(struct connection *connection);
void connections_close(struct http_server *server);

uint64_t connection_now(const struct connection *connection); /* loop time, ms */

/* http_session.c */

/* HTTP is spoken over the connection from now on. */
void http_session_open(struct connection *connection);

/* It has answered, and waits for another request. */
bool http_session_is_idle(const struct connection *connection);

/* exchange.c */

/* The session that a request came in; both are asked while it is answered. */
struct exchange_session {
    bool (*persists)(
        const struct connection *connection);        /* can it go on after an answer that is given now? */
    void (*answered)(struct connection *connection); /* all of the answer has left */
};

struct exchange {
    struct http_server *server;
    const struct http_request *request;
    struct connection *connection;
    const struct exchange_session *session;
    struct exchange_work work;
    void *attached;          /* its owner's; by malloc */
    struct buf request_body; /* what has come of it */
    size_t body_most;        /* 0 = none is expected */
    enum error_code body_too_long;
    struct buf headers;  /* of the answer, besides those of every answer */
    struct buf queue;    /* of the answer: what waits */
    const uint8_t *body; /* what is to follow, and outlives the exchange */
    size_t body_size;
    uint64_t last_keepalive; /* loop time, ms */
    char *const *embed;      /* origins whose pages may frame the answer; or NULL */
    char etag[ETAG_BYTES];   /* of the answer; "": none */
    bool chunked;            /* the answer's length is not known */
    bool framed;             /* and it is told in chunks, not by the connection's end */
    bool complete, answered, done, persists;
    bool shared;  /* any page may have the answer */
    bool refused; /* the page is; it may see that there is an answer, to tell its reader why */
    struct error *warnings;
    size_t warning_count;
};

struct exchange *exchange_open(struct http_server *server, const struct http_request *request,
                               const struct exchange_session *session);
void exchange_close(struct exchange *x);
void exchange_sent(struct exchange *x);                   /* bytes have left */
bool exchange_done(const struct exchange *x);             /* all of it has been sent: close it */
bool exchange_persists(const struct exchange *x);         /* and another one may follow it */
bool exchange_ends_with_client(const struct exchange *x); /* that closes its side */
void exchange_look(struct exchange *x);                   /* once a second */
void exchange_take_body(struct exchange *x, const void *data, size_t size); /* what has come of it */
bool exchange_streams_body(const struct exchange *x); /* its body may take as long as it likes */

#endif
