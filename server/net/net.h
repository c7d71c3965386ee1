/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The net stage: HTTP and WebSocket, on the same libuv loop as everything else. */
#ifndef FACCIA_NET_NET_H
#define FACCIA_NET_NET_H

#include "server/access/token.h"
#include "server/base/buf.h"
#include "server/base/document_store.h"
#include "server/base/reader_process.h"
#include "server/net/offer.h"
#include "server/stream/stream.h"

struct board;
struct bus;
struct library;
struct transport_tls;

/* What the network is told; server/app/settings_table.c has the bounds and defaults of what are settings. */
struct net_options {
    const char *host;                /* address, name or interface to listen on, "*" = all */
    unsigned port;                   /* 0 = any free one */
    bool remote;                     /* allow a host that is not loopback, which needs secrets too */
    const int *listen_fds;           /* sockets that are listened on already, instead of host and port; */
    unsigned listen_count;           /* none */
    const struct transport_tls *tls; /* NULL: none */
    unsigned hsts;                   /* seconds of Strict-Transport-Security; 0 = none */
    char *const *origins;          /* pages that are let in, NULL-terminated; NULL = those of this machine */
    char *const *host_names;       /* by which it is asked, see access/host.h; NULL: its own alone */
    char *const *embed;            /* origins whose pages may frame its own; NULL: none */
    const struct secrets *secrets; /* tokens are demanded; NULL = anybody may do all */
    const struct revocations *revocations; /* are added to those that are known; read at once; or NULL */
    const char *web, *models;              /* folders */
    const char *media;                     /* folder of recordings; NULL = none */
    bool shares;                           /* what is spoken, with other daemons */
    struct bus *bus;                       /* by which they share rooms; NULL = none */
    struct board *board;                   /* on which they count together; NULL = none */
    const char *scenes;                    /* folder of scenes that operators keep; NULL = none */
    unsigned scene_bytes;                  /* of one */
    unsigned scene_count;
    struct reader reader;         /* of works that are saved */
    struct library *library;      /* NULL = none */
    bool editing;                 /* who may operate saves gestures and works */
    const char *gestures, *works; /* folders of those; NULL = none */
    struct document_store_listener on_gestures;
    unsigned text_bytes;          /* longest text of one speak or POST */
    unsigned message_bytes;       /* longest message of a client */
    unsigned play_bytes;          /* of an uploaded recording, or of a .fap file */
    unsigned queue;               /* utterances that wait on one stream */
    unsigned open;                /* texts that one client is writing */
    unsigned open_seconds;        /* one that is not written for so long is closed; 0 = never */
    unsigned connections;         /* open connections */
    unsigned connections_above;   /* that are told so, and what the operator asks */
    unsigned rooms;               /* that have somebody in them */
    unsigned address_connections; /* of one address, or one token's subject; 0 = no limit of its own */
    unsigned address_rooms;    /* that one of them had made, and that have somebody in them; 0 = no limit */
    unsigned address_requests; /* utterances and POSTs of such in a minute; 0 = no limit */
    unsigned send_bytes;       /* unsent bytes at which media to one client wait */
    unsigned send_bytes_max;   /* unsent bytes at which the client is closed as too slow */
    unsigned lag_seconds;      /* in a room, a client's media that wait for longer are left out */
    unsigned stall_seconds;    /* a client that takes nothing for so long while bytes wait is closed */
    unsigned hold_seconds;     /* what is said to an empty room waits so long for somebody */
    unsigned ping_seconds;     /* a socket silent for so long is pinged, and closed a third later */
};

enum { NET_CONNECTIONS_ABOVE = 50 };

struct net;

/* Listens at once. NULL with *e: "bad-field" (host not loopback without remote), "listen" or what assets_load
 * says. */
struct net *net_open(const struct pipeline *pipeline, const struct offer_source *offer,
                     const struct net_options *options, struct error *e);

/* Appends the address of the socket of that number, from 0, that is listened on, as in "http://[::1]:8080/".
 * False: there is none. */
bool net_address(const struct net *net, size_t number, struct buf *out);

/* The voices are there: until then /healthz answers 503 and a speak fails with "voice-unavailable". */
void net_set_ready(struct net *net);

/* No voice has come, and none is waited for: /healthz answers 503 with that reason, a literal, until there is
 * one after all. */
void net_set_unavailable(struct net *net, const char *reason);

/* Takes the limits, origins, secrets and revocations of options; the rest stays as it is. */
void net_change(struct net *net, const struct net_options *options);

/* Takes no new connection and no new utterance. */
void net_drain(struct net *net);

/* Does anybody still hear something? */
bool net_busy(const struct net *net);

/* Tells all WebSocket clients goodbye with the reason; their connections close when that has left. */
void net_dismiss(struct net *net, const char *reason);

/* Closes all connections; then run the loop until it is empty and call net_free. */
void net_close(struct net *net);
void net_free(struct net *net);

#endif
