/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the interface share. */
#ifndef FACCIA_API_API_INTERNAL_H
#define FACCIA_API_API_INTERNAL_H

#include "server/access/quota.h"
#include "server/access/revocations.h"
#include "server/api/api.h"
#include "server/api/heads.h"
#include "server/api/principal.h"
#include "server/api/request_json.h"
#include "server/api/search_queue.h"
#include "server/base/error_json.h"
#include "server/base/metrics.h"
#include "server/http/exchange.h"
#include "server/rooms/channel.h"
#include "server/rooms/events.h"
#include "server/synthesis/recording.h"

struct api {
    struct api_options options;
    const struct pipeline *pipeline;
    struct offer_source offer;
    struct http_server *http;
    struct rooms *rooms;
    struct heads heads;
    struct client *clients; /* WebSockets that are open */
    uint64_t streams;       /* numbers given to them so far */
    bool ready, draining;
    const char *unavailable; /* why nothing can be spoken, nor soon will be; or NULL */
    struct quota quota;
    struct shared_limits *shared_limits; /* with other daemons; NULL: none */
    struct secrets secrets;              /* those of options.secrets that count */
    struct secrets_revoked revoked;
    struct revocations revocations;
    uint64_t trim_at;                       /* loop time from which memory may be given back again, ms */
    struct events *events;                  /* clients that follow a room over HTTP */
    struct search_queue searches;           /* in the library */
    struct search_queue saves;              /* of documents: speech does not wait for them */
    struct search_queue reads;              /* lists, reads and removals there, which do not wait for saves */
    json_t *more_languages;                 /* of hello */
    const struct offer_voice *languages_of; /* the list from which they were found */
};

struct api *exchange_api(const struct exchange *x);

/* messages.c: JSON of what is on offer; new references */
json_t *message_rooms(const struct api *api, const char *only); /* NULL or "": all */
json_t *message_hello(struct api *api, const char *stream);
json_t *message_voices(const struct api *api);
json_t *message_models(const struct api *api);
json_t *message_expressions(const struct api *api);
json_t *message_health(const struct api *api);

/* client.c: WebSocket clients */
void client_accept(struct exchange *x); /* a request asks for a WebSocket */
bool clients_busy(const struct api *api);
void clients_dismiss(struct api *api, const char *reason); /* closes all, with the reason */
void clients_revoke(
    struct api *api); /* those whose secret or token is gone lose their rights, and are told */

/* routes.c: answers what has come in */
void routes_serve(struct exchange *x);

/* What answers a request returns 0, for routes to pass on. */

/* speech_route.c: /v1/speech, by POST or GET */
int speech_ask(struct exchange *x);
extern const struct members speech_members; /* that it knows */

/* What is to be spoken, out of an HTTP request: its query, and its body when it has one, which is the text,
 * or a JSON object with it. */
struct post_text {
    struct exchange *x;
    struct members known; /* of the body, but for its text; others of the query are passed over */
    const char *markup;   /* by the type of the body; NULL: none is said */
    bool json, bodiless;
    json_t *object; /* of a JSON body, once it has been read */
};

/* Looks at the type of the body, which is expected from then on. -1 after the answer 415, with *result to be
 * returned. */
int post_text_begin(struct post_text *p, struct exchange *x, const struct members *known, int *result);

/* All has come. -1 with *e. Members of a body count for more than those of the query. */
int post_text_request(struct post_text *p, struct speech_request *request, struct error *e);
void post_text_free(struct post_text *p);

/* media_routes.c */

/* A recording of the folder of those. -1 with *e: "unknown-media" when there is no such folder, or as
 * recording_source_in. */
int media_source(const struct api *api, struct recording_source *source, const char *name, struct error *e);
int media_get(struct exchange *x); /* GET /v1/media */
int play_post(struct exchange *x); /* POST /v1/play?room= */

/* library_routes.c */
int library_get(struct exchange *x); /* GET /v1/library and below */

/* Puts what a passage says into the request that names one. -1 with *e, a field of the request's. */
int passage_resolve(const struct api *api, struct speech_request *request, struct error *e);

/* room_routes.c */
int room_commands(struct exchange *x, const char *room); /* POST /v1/rooms/ROOM/commands */
int room_say(struct exchange *x);                        /* POST /v1/say?room= */
int room_command(struct exchange *x,
                 const char *type); /* POST /v1/TYPE?room=: the body is the message, or empty */

/* Is the room that the address names led by another daemon? Then forwards the command (command_pack) to it,
 * and answers when that one has. */
bool room_is_remote(const struct exchange *x);
int room_forward(struct exchange *x, json_t *packed);

/* The room that the address names; NULL after the answer, with *result to be returned. */
struct channel *room_asked(struct exchange *x, int *result);

/* room_events.c */
int room_events(struct exchange *x); /* GET /v1/events?room= */
void room_events_revoke(struct api *api);

/* documents.c: documents that operators and editors keep, by GET, PUT and DELETE */
int scenes_serve(struct exchange *x);   /* /v1/scenes and below */
int gestures_serve(struct exchange *x); /* /v1/gestures and below */
int works_serve(struct exchange *x);    /* /v1/library/files and below */

/* revoke.c: the secrets, or what is revoked, have changed: clients whose secret or token is gone lose their
 * rights, and are told. */
void rights_renew(struct api *api);

/* Those that come in place of the present ones: what is missing is revoked everywhere. */
void rights_replace(struct api *api, const struct secrets *secrets);
void rights_revoke_all(struct api *api, const struct revocations *all); /* NULL: none */
int revoke_post(struct exchange *x);                                    /* POST /v1/revoke */

#endif
