/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices and heads of the daemon, as the library's casts choose from them. */
#ifndef FACCIA_API_CAST_OFFER_H
#define FACCIA_API_CAST_OFFER_H

#include "server/library/cast.h"

struct api;

/* A copy, for another thread. Call it on the loop's thread; free it with cast_offer_free. */
struct cast_offer *cast_offer_new(const struct api *api);
void cast_offer_free(struct cast_offer *offer);

#endif
