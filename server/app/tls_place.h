/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The certificate with which the daemon speaks TLS, as the settings name it. */
#ifndef FACCIA_APP_TLS_PLACE_H
#define FACCIA_APP_TLS_PLACE_H

#include "server/app/settings.h"
#include "server/http/transport.h"

struct tls_place {
    struct transport_tls tls; /* its texts are the place's own */
    bool on;
};

/* Names the files. Makes those of --tls-self-signed unless valid ones exist, and logs their fingerprint; what
 * the operator names is checked when the transport opens. -1 with *e. The caller frees it in either case. */
int tls_place_open(struct tls_place *place, const struct settings *settings, struct error *e);
void tls_place_free(struct tls_place *place);

#endif
