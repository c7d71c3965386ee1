/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the daemon is, and by which token it is asked: from options and the environment, the same for all
 * programs beside it. */
#ifndef FACCIA_DOORS_PLACE_H
#define FACCIA_DOORS_PLACE_H

#include "server/base/buf.h"
#include "server/doors/remote.h"

struct place {
    const char *url;
    char *token; /* NULL: none */
};

/* FACCIA_URL, FACCIA_TOKEN, or what one has without them. A FACCIA_TOKEN that is none is told of and left
 * out: it may be the daemon's secret, which must not be sent. */
void place_open(struct place *place);
void place_close(struct place *place);

/* The first line of the file is the token. -1 after a message, also when the line is no token. */
int place_read_token(struct place *place, const char *file);

/* A new id for an utterance. */
void place_make_id(char *id, size_t cap);

#endif
