/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One who asks over the Wyoming protocol: describe, synthesize, and the streaming form (synthesize-start,
 * -chunk, -stop).
 */
#ifndef FACCIA_DOORS_WYOMING_CLIENT_H
#define FACCIA_DOORS_WYOMING_CLIENT_H

#include "server/base/buf.h"
#include "server/doors/remote.h"
#include "server/doors/sayer.h"

struct wyoming {
    uv_loop_t *loop;
    struct remote *remote;
    struct sayer *sayer; /* in the room; NULL: there is none */
    const char *room;    /* whose face says it, too; NULL: none */
    bool silent;         /* silence goes back, as long as the speech */
    struct wyoming_client *clients;
    unsigned count;
};

enum { WYOMING_CLIENTS = 50 };

/* Takes one that waits. */
void wyoming_accept(struct wyoming *wyoming, uv_stream_t *listener);
/* Lets all go. */
void wyoming_end(struct wyoming *wyoming);

#endif
