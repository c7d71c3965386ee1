/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon's interface: its HTTP routes, its WebSocket clients and the commands that both can give, on the
 * same libuv loop as everything else. */
#ifndef FACCIA_API_API_H
#define FACCIA_API_API_H

#include "server/access/token.h"
#include "server/api/offer.h"
#include "server/base/buf.h"
#include "server/base/document_store.h"
#include "server/base/reader_process.h"
#include "server/http/http_server.h"
#include "server/rooms/rooms.h"
#include "server/stream/stream.h"

struct board;
struct bus;
struct library;

/* What it is told; server/app/settings_table.c has the bounds and defaults of what are settings. */
struct api_options {
    struct http_options http;      /* tokens: follows from secrets */
    struct room_limits rooms;      /* send_bytes: follows from http */
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
    unsigned text_bytes;       /* longest text of one speak or POST */
    unsigned play_bytes;       /* of an uploaded recording, or of a .fap file */
    unsigned open;             /* texts that one client is writing */
    unsigned open_seconds;     /* one that is not written for so long is closed; 0 = never */
    unsigned address_requests; /* utterances and POSTs of one address, or token's subject, in a minute; 0 = no
                                  limit */
    unsigned lag_seconds;      /* in a room, a client's media that wait for longer are left out */
};

enum { API_CONNECTIONS_ABOVE = 50 };

struct api;

/* Listens at once. NULL with *e: as http_server_open, or "bad-model" when a head cannot be read. */
struct api *api_open(const struct pipeline *pipeline, const struct offer_source *offer,
                     const struct api_options *options, struct error *e);

/* Appends the address of the socket of that number, from 0, that is listened on, as in "http://[::1]:8080/".
 * False: there is none. */
bool api_address(const struct api *api, size_t number, struct buf *out);

/* The voices are there: until then /healthz answers 503 and a speak fails with "voice-unavailable". */
void api_set_ready(struct api *api);

/* No voice has come, and none is waited for: /healthz answers 503 with that reason, a literal, until there is
 * one after all. */
void api_set_unavailable(struct api *api, const char *reason);

/* Takes the limits, origins, secrets and revocations of options; the rest stays as it is. */
void api_change(struct api *api, const struct api_options *options);

/* Takes no new connection and no new utterance. */
void api_drain(struct api *api);

/* Does anybody still hear something? */
bool api_busy(const struct api *api);

/* Tells all WebSocket clients goodbye with the reason; their connections close when that has left. */
void api_dismiss(struct api *api, const char *reason);

/* Closes all connections; then run the loop until it is empty and call api_free. */
void api_close(struct api *api);
void api_free(struct api *api);

#endif
