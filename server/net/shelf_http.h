/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shelf (base/shelf.h) over HTTP: GET of its address lists it; GET, PUT, DELETE of ADDRESS/NAME. The disk
 * is waited for in threads of their own, each client's requests one after the other. */
#ifndef FACCIA_NET_SHELF_HTTP_H
#define FACCIA_NET_SHELF_HTTP_H

#include "server/base/document_store.h"
#include "server/net/net_internal.h"

struct shelf_service {
    const char *path;    /* "/v1/scenes" */
    const char *members; /* of the list: "scenes" */
    const char *type;    /* of a document */
    /* Is it one, of that name? In any thread. -1 with *e. */
    int (*check)(const char *name, const void *data, size_t size, struct error *e);
    /* The same where it takes a process apart: NULL, or instead of check. */
    int (*check_apart)(const struct reader *reader, const char *name, const void *data, size_t size,
                       const atomic_bool *given_up, struct error *e);
};

/* The shelf is copied; what it and the listener point to lives as long as the daemon. */
int shelf_serve(struct exchange *x, const struct shelf_service *service, const struct document_store *shelf,
                struct document_store_listener listener);

#endif
