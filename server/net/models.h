/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A head model as the parts in which the socket sends it. */
#ifndef FACCIA_NET_MODELS_H
#define FACCIA_NET_MODELS_H

#include "server/net/assets.h"

/* Fills name, title and parts from the asset's JSON. -1 with *e "bad-model" when it is no head model; file is
 * for the message. */
int model_split(struct model *model, const char *file, struct error *e);
void model_free(struct model *model);

#endif
