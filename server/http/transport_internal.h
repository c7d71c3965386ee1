/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of this folder share. */
#ifndef FACCIA_HTTP_TRANSPORT_INTERNAL_H
#define FACCIA_HTTP_TRANSPORT_INTERNAL_H

#include "server/http/transport.h"
#include <libwebsockets.h>

struct transport {
    struct peer_calls calls;
    struct lws_context *context;
    struct lws_vhost *vhost;
    uv_idle_t *idle;  /* NULL: closing */
    struct peer *due; /* see later() */
};

/* transport_tls.c */

/* TLS 1.2 and later. */
long transport_tls_options(void);

/* Tells the peer that nothing follows. */
void transport_end_tls(struct lws *wsi);

#endif
