/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves a host name or an interface to the addresses to listen on, and lists the addresses at which other
 * machines reach a socket. */
#ifndef FACCIA_HTTP_LISTEN_ADDRESS_H
#define FACCIA_HTTP_LISTEN_ADDRESS_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <sys/socket.h>

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
