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

/* Finds the files, and makes those of --tls-self-signed when there are none that are still good: the log
 * tells their fingerprint. -1 with *e. Free it all the same. */
int tls_place_open(struct tls_place *place, const struct settings *settings, struct error *e);
void tls_place_free(struct tls_place *place);

#endif
