/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who may come in, as the settings' files say. */
#ifndef FACCIA_APP_ACCESS_PLACE_H
#define FACCIA_APP_ACCESS_PLACE_H

#include "server/access/revocations.h"

struct settings;

struct access_place {
    struct secrets secrets; /* none: no token is demanded */
    struct revocations revocations;
};

/* -1 with *e; then it holds nothing. */
int access_place_load(struct access_place *place, const struct settings *settings, struct error *e);
void access_place_free(struct access_place *place);

#endif
