/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was said to rooms in which nobody was: kept for a while, and spoken when somebody comes. */
#ifndef FACCIA_NET_HOLD_H
#define FACCIA_NET_HOLD_H

#include "server/base/error.h"
#include "server/synthesis/speech_request.h"

struct net;
struct stream;

/* Of all rooms together. */
enum { HOLD_MOST = 100 };

struct hold {
    struct held *first; /* oldest first */
    size_t count;
    /* What was held will not be spoken: tells who looks on in the room. */
    void (*unheard)(struct net *net, const char *room, const char *id, const struct error *e);
};

/* Keeps a copy of the request for net->options.hold_seconds. -1 with *e: "queue-full". */
int hold_keep(struct net *net, const char *room, const struct speech_request *request, struct error *e);

/* Somebody has come into the room: speaks what was kept for it, by priority and in its order. */
void hold_speak(struct net *net, const char *room, struct stream *stream);

/* Once a second: what has waited too long is given up, with an error "unheard" to who looks on. */
void hold_look(struct net *net);

void hold_free(struct hold *hold);

#endif
