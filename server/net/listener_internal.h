/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the listeners: the sockets that are listened on, and descriptors in reserve. */
#ifndef FACCIA_NET_LISTENER_INTERNAL_H
#define FACCIA_NET_LISTENER_INTERNAL_H

#include "server/net/listener.h"
#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <uv.h>

enum { RESERVE = 4 }; /* descriptors with which somebody can be told that there are no more */

struct listener {
    struct listeners *all;
    struct sockaddr_storage at;
    int fd;
    uv_poll_t poll;
};

struct listeners {
    struct net *net;
    struct listener **list;
    size_t count, cap;
    int reserve[RESERVE];
    unsigned reserved;
    bool paused;
    uint64_t complained; /* loop time, ms */
};

/* listener_open.c: finds, checks and opens the sockets. -1 with *e, and none is open. */
int listener_sockets_open(struct listeners *all, struct error *e);
void listener_sockets_drop(struct listeners *all); /* before they are polled */

#endif
