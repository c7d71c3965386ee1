/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the daemon's stages offer, described for the network. */
#ifndef FACCIA_APP_DAEMON_OFFER_H
#define FACCIA_APP_DAEMON_OFFER_H

#include "server/api/offer.h"
#include "server/synthesis/synthesis.h"

struct daemon_offer;

/* The pipeline is borrowed; its voices may come later, its expressions may be replaced. */
struct daemon_offer *daemon_offer_new(const struct pipeline *pipeline);
void daemon_offer_free(struct daemon_offer *offer);
struct offer_source daemon_offer_source(struct daemon_offer *offer);

#endif
