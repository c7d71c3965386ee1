/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carries the bytes of connections, plain or over TLS, with libwebsockets on the program's libuv loop. No
 * other folder includes that library. What is spoken over one is its owner's affair: libwebsockets' own
 * readers of HTTP/1, HTTP/2 and WebSocket are never entered. */
#ifndef FACCIA_HTTP_TRANSPORT_H
#define FACCIA_HTTP_TRANSPORT_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <sys/uio.h>
#include <uv.h>

enum {
    PEER_READ_BYTES = 65536,  /* at most, at a time */
    PEER_WRITE_BYTES = 32768, /* that wait to leave one connection, at most */
};

struct transport;
struct peer;

struct peer_calls {
    void (*read)(void *owner, const char *bytes, size_t size); /* bytes have come */
    void (*eof)(void *owner);    /* the peer sends nothing more, but may still read; never of TLS */
    void (*sent)(void *owner);   /* all that was written has left */
    void (*closed)(void *owner); /* it is gone: the last call */
};

/* Certificate and key, in PEM; both stay the caller's. */
struct transport_tls {
    const char *cert, *key; /* files */
};

/* NULL with *e ("listen": libwebsockets cannot begin, or as transport_check_tls). tls: NULL for none. With
 * it, a connection is TLS when its peer begins so, and plain when it does not: see peer_secure. */
struct transport *transport_open(uv_loop_t *loop, const struct peer_calls *calls,
                                 const struct transport_tls *tls, struct error *e);

/* Whether the files hold a certificate and its key, and nobody else can read the key. -1 with *e
 * ("bad-field"). */
int transport_check_tls(const struct transport_tls *tls, struct error *e);

/* Reads the files with which it was opened anew; connections that are open go on with what they have. -1 with
 * *e, and nothing is changed. */
int transport_renew_tls(struct transport *transport, const struct transport_tls *tls, struct error *e);

/* Closes what is open. Then the loop must run before it is freed. */
void transport_close(struct transport *transport);
void transport_free(struct transport *transport);

/* Takes the connected socket, which is closed with it, and reads from it. Never NULL; one that fails is
 * told as closed, later. */
struct peer *peer_open(struct transport *transport, int fd, void *owner);

/* Is it TLS? Known once bytes have come. */
bool peer_secure(const struct peer *peer);

/* Takes bytes that are to leave, as many as there is room for, and returns how many; when that is not all,
 * the rest can be written once `sent` was called. Of one that closes it takes all, and they are lost. */
size_t peer_write(struct peer *peer, const struct iovec *parts, size_t count);

/* Bytes that wait. */
size_t peer_unsent(const struct peer *peer);

void peer_read(struct peer *peer, bool on);

/* Tells the peer, when all has left, that nothing follows. Reading goes on. */
void peer_finish(struct peer *peer);

/* It is closed soon after. */
void peer_close(struct peer *peer);

#endif
