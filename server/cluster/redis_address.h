/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The address of a Redis server: redis://[[USER]:PASSWORD@]HOST[:PORT][/NUMBER], or
 * unix://[[USER]:PASSWORD@]/PATH, as in redis-cli -u (percent-encoded name and password). */
#ifndef FACCIA_CLUSTER_REDIS_ADDRESS_H
#define FACCIA_CLUSTER_REDIS_ADDRESS_H

#include "server/base/error.h"

enum { REDIS_PORT = 6379 };

struct redis_address {
    char *user, *password; /* NULL = none */
    char *host;            /* NULL = Unix socket at path */
    char *path;
    int port, number;
    char *shown; /* without the password */
};

/* Parses an address. Returns -1 with *e ("bad-field", field "--cluster") and the reason. */
int redis_address_read(const char *text, struct redis_address *address, struct error *e);
void redis_address_free(struct redis_address *address);

#endif
