/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the transport. */
#ifndef FACCIA_HTTP_TRANSPORT_INTERNAL_H
#define FACCIA_HTTP_TRANSPORT_INTERNAL_H

#include "server/http/transport.h"
#include <libwebsockets.h>

struct transport {
    struct peer_calls calls;
    struct lws_context *context;
    struct lws_vhost *vhost;
    uv_idle_t *idle;  /* NULL: closing */
    struct peer *due; /* peers to handle in the next loop iteration, see later() */
};

/* transport_tls.c */

/* Allows TLS 1.2 and later. */
long transport_tls_options(void);

/* Sends the peer a TLS close_notify. */
void transport_end_tls(struct lws *wsi);

#endif
