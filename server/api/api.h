/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP and WebSocket API of the daemon: routes, WebSocket clients and the commands available to both. It
 * runs on the daemon's libuv loop. */
#ifndef FACCIA_API_API_H
#define FACCIA_API_API_H

#include "server/access/token.h"
#include "server/api/documents/document_store.h"
#include "server/api/offer.h"
#include "server/base/buf.h"
#include "server/base/work/reader_process.h"
#include "server/http/http_server.h"
#include "server/rooms/rooms.h"
#include "server/stream/stream.h"

struct presence;
struct bus;
struct library;

/* Options of the API. Bounds and defaults of settings are in server/daemon/settings_table.c. */
struct api_options {
    struct http_options http; /* `tokens` is derived from `secrets` */
    struct room_limits rooms; /* `send_bytes` is derived from `http` */
    char *const *origins;     /* page origins allowed, NULL-terminated; NULL: only those of this machine */
    char *const *host_names;  /* accepted Host names, see access/host.h; NULL: only the machine's own */
    char *const *embed;       /* origins whose pages may frame ours; NULL: none */
    const struct secrets *secrets; /* token secrets; NULL: no tokens needed, all rights for every client */
    const struct revocations *revocations; /* copied at once into the known revocations; NULL: none */
    const char *web, *models;              /* folders */
    const char *media;                     /* folder of recordings; NULL: none */
    bool shares;                           /* speech is shared with other daemons */
    bool hears;                            /* what listeners say is recognised */
    struct bus *bus;                       /* shares rooms with other daemons; NULL: none */
    struct presence *presence;             /* shares limits and revocations with other daemons; NULL: none */
    const char *sessions;                  /* folder of recorded sessions of studies; NULL: none */
    const char *scenes;                    /* folder of scenes saved by operators; NULL: none */
    unsigned scene_bytes;                  /* longest scene, bytes */
    unsigned scene_count;
    const char *reports;          /* folder of readers' reports; NULL: none */
    bool open_reports;            /* readers need no token to report */
    struct reader reader;         /* checks works before they are saved */
    struct library *library;      /* NULL: none */
    bool editing;                 /* holders of the operate right may save gestures and works */
    const char *gestures, *works; /* their folders; NULL: none */
    struct document_store_listener on_gestures;
    unsigned text_bytes;       /* longest text of one speak or POST, bytes */
    unsigned play_bytes;       /* largest uploaded recording or .fap file, bytes */
    unsigned open;             /* unfinished texts per client */
    unsigned open_seconds;     /* closes an unfinished text that is idle for this long; 0: never */
    unsigned address_requests; /* utterances and POSTs a minute per address or token subject; 0: no limit */
    const char *film_program;  /* path of faccia; "": no films */
    unsigned films;            /* jobs of films, finished ones included; 0: none */
    unsigned films_of_client;  /* the same of one client */
    unsigned film_seconds;     /* longest film */
    unsigned coach_seconds;    /* longest recording that is compared with a text; 0: none is */
    unsigned lag_seconds;      /* in a room, drops a client's media that have been queued for longer */
};

enum { API_CONNECTIONS_ABOVE = 50 };

struct api;

/* Starts listening at once. Returns NULL with *e: as http_server_open, or "bad-model" if a head cannot be
 * read. */
struct api *api_open(const struct pipeline *pipeline, const struct offer_source *offer,
                     const struct api_options *options, struct error *e);

/* Appends the URL of listening socket `number` (from 0), such as "http://[::1]:8080/". False if `number` is
 * out of range. */
bool api_address(const struct api *api, size_t number, struct buf *out);

/* The same of addresses at which other machines may reach the daemon. */
bool api_outside_address(const struct api *api, size_t number, struct buf *out);

/* Marks the voices as loaded. Until then /healthz answers 503 and speak fails with "voice-unavailable". */
void api_set_ready(struct api *api);

/* Reports that no voice was found and none is expected. /healthz answers 503 with `reason`, a string
 * literal, until api_set_ready is called. */
void api_set_unavailable(struct api *api, const char *reason);

/* Applies the limits, origins, secrets and revocations of `options`; all other options stay unchanged. */
void api_change(struct api *api, const struct api_options *options);

/* Stops accepting connections and utterances. */
void api_drain(struct api *api);

/* Returns whether speech or a response is still being produced or sent. */
bool api_busy(const struct api *api);

/* Closes every WebSocket with `reason`, after its queued data has been sent. */
void api_dismiss(struct api *api, const char *reason);

/* Closes all connections. Then run the loop until it is empty and call api_free. */
void api_close(struct api *api);
void api_free(struct api *api);

#endif
