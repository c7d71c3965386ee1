/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transfers bytes over connections, plain or TLS, with libwebsockets on the program's libuv loop. No other
 * folder includes that library. The owner of a connection parses its bytes: the HTTP/1, HTTP/2 and
 * WebSocket parsers of libwebsockets are never used. */
#ifndef FACCIA_HTTP_TRANSPORT_H
#define FACCIA_HTTP_TRANSPORT_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <sys/uio.h>
#include <uv.h>

enum {
    PEER_READ_BYTES = 65536,  /* most bytes per read */
    PEER_WRITE_BYTES = 32768, /* most unsent bytes of one connection */
};

struct transport;
struct peer;

struct peer_calls {
    void (*read)(void *owner, const char *bytes, size_t size); /* bytes have arrived */
    void (*eof)(void *owner);    /* the peer sends nothing more, but may still read; never called for TLS */
    void (*sent)(void *owner);   /* everything written has been sent */
    void (*closed)(void *owner); /* it is gone; this is the last call */
};

/* PEM files of the certificate and its key. The strings stay the caller's. */
struct transport_tls {
    const char *cert, *key; /* file names */
};

/* NULL with *e ("listen": libwebsockets cannot start, or as transport_check_tls). tls NULL: no TLS.
 * Otherwise each peer decides how it begins, TLS or plain: see peer_secure. */
struct transport *transport_open(uv_loop_t *loop, const struct peer_calls *calls,
                                 const struct transport_tls *tls, struct error *e);

/* Checks that the files hold a certificate and its key, and that other users cannot read the key. -1 with
 * *e ("bad-field"). */
int transport_check_tls(const struct transport_tls *tls, struct error *e);

/* Reloads the files given to transport_open; open connections keep their certificate. -1 with *e, changing
 * nothing. */
int transport_renew_tls(struct transport *transport, const struct transport_tls *tls, struct error *e);

/* Closes all connections. The loop must run before the transport is freed. */
void transport_close(struct transport *transport);
void transport_free(struct transport *transport);

/* Takes ownership of the connected socket and reads from it. Never returns NULL: a failure is reported
 * later by `closed`. */
struct peer *peer_open(struct transport *transport, int fd, void *owner);

/* Returns whether it uses TLS. Known once bytes have arrived. */
bool peer_secure(const struct peer *peer);

/* Sends as many bytes as there is room for, and returns how many. If not all fit, write the rest once
 * `sent` is called. A closing peer accepts all bytes and discards them. */
size_t peer_write(struct peer *peer, const struct iovec *parts, size_t count);

/* Returns the number of unsent bytes. */
size_t peer_unsent(const struct peer *peer);

void peer_read(struct peer *peer, bool on);

/* Ends the sending side once everything has been sent. Reading continues. */
void peer_finish(struct peer *peer);

/* Closes it soon after. */
void peer_close(struct peer *peer);

#endif
