/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One TCP connection (or one of a unix socket). What is spoken over it is a protocol's: HTTP first, and then
 * perhaps WebSocket. */
#ifndef FACCIA_NET_CONNECTION_H
#define FACCIA_NET_CONNECTION_H

#include "server/http/transport.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

struct net;
struct connection;

/* What a protocol does. All but read, sent and free may be NULL. */
struct connection_protocol {
    void (*read)(struct connection *connection, const char *bytes, size_t size); /* bytes have come */
    void (*eof)(struct connection *connection);   /* no more will come; NULL: it is closed */
    void (*sent)(struct connection *connection);  /* all bytes have left: there is room for others */
    void (*go_on)(struct connection *connection); /* what connection_later is about */
    void (*look)(struct connection *connection);  /* from time to time */
    void (*free)(struct connection *connection);  /* it goes with the connection, or before */
};

struct connection {
    struct net *net;
    struct connection *next, **self;            /* in the net's list */
    struct connection *next_due;                /* among those that connection_later is about */
    const struct connection_protocol *protocol; /* NULL = none (any more) */
    struct http_session *http;                  /* its: one of these two */
    struct socket *socket;
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
struct connection *connection_open(struct net *net, int fd, const struct sockaddr_storage *peer);

/* Speaks that from now on; what was spoken before has been freed. */
void connection_use(struct connection *connection, const struct connection_protocol *protocol);

/* Takes bytes to be sent, as many as there is room for, and returns how many. When that is not all, the
 * protocol is told (`sent`) once there is room again. Of one that closes all is taken, and lost. */
size_t connection_send(struct connection *connection, const void *bytes, size_t size);
size_t connection_send_parts(struct connection *connection, const struct iovec *parts, size_t count);

/* Bytes that have not left. */
size_t connection_unsent(const struct connection *connection);

void connection_read(struct connection *connection, bool on);

/* Is it carried by TLS? Known once bytes have come. */
bool connection_secure(const struct connection *connection);

/* Counts it for another one from now on. False, and nothing is changed, when that one has too many. */
bool connection_count(struct connection *connection, const char *key);

/* Lets the protocol go on, soon: for what is done from within an answer's own making. */
void connection_later(struct connection *connection);

/* Says that nothing more comes, and waits, not for long, for the other end to close: what it still sends
 * would make the kernel take back what is on its way to it. */
void connection_finish(struct connection *connection);

/* It is gone soon after, with what belongs to it. */
void connection_close(struct connection *connection);
void connections_close(struct net *net);

/* Loop time, ms. */
uint64_t connection_now(const struct connection *connection);

#endif
