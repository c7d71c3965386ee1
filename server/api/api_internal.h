/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the API. */
#ifndef FACCIA_API_API_INTERNAL_H
#define FACCIA_API_API_INTERNAL_H

#include "server/access/quota.h"
#include "server/access/revocations.h"
#include "server/access/token.h"
#include "server/api/api.h"
#include "server/base/error.h"
#include "server/base/json/error_json.h"
#include "server/base/metrics.h"
#include "server/codec/coder_pool.h"
#include "server/export/speech_export.h"
#include "server/http/exchange.h"
#include "server/http/static_files.h"
#include "server/rooms/channel.h"
#include "server/rooms/events.h"
#include "server/synthesis/recording.h"
#include "server/synthesis/speech_request.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* Reads requests from JSON and from the query of an address. */

struct http_request;
struct idle_options;

/* Converts a member to a field value, which borrows its string. NULL and structures become a type that no
 * field accepts. */
struct request_value value_from_json(const json_t *member);

/* Sets the request's fields from the members of a speak message or of a query. except: a query member to
 * skip, or NULL. -1 with *e. */
int request_from_json(struct speech_request *request, const json_t *object, struct error *e);
int request_from_query(struct speech_request *request, const struct http_request *from, const char *except,
                       struct error *e);
json_t *request_to_json(const struct speech_request *request); /* NULL: its text is not UTF-8 */

/* Reads the options of an idle message. -1 with *e. */
int idle_from_json(const json_t *message, const struct speech_request *defaults, uint64_t seed,
                   struct idle_options *options, bool *on, struct error *e);

/* Members that an address or a body may have. */
struct members {
    bool speech;             /* all fields of a speech request except its text */
    const char *const *more; /* further names, NULL-terminated; or NULL */
};

/* Calls warn for each unknown member ("unknown-member", with its field). text: the query may contain one. */
void query_check(const struct http_request *request, const struct members *known, bool text,
                 void (*warn)(void *ctx, const struct error *e), void *ctx);
void members_check(const json_t *object, const struct members *known,
                   void (*warn)(void *ctx, const struct error *e), void *ctx);

/* Reads a boolean ("1", "true", "0", "false"); NULL is false. -1 with *e "bad-field". */
int query_flag(const char *value, const char *name, bool *flag, struct error *e);

/* Files that the daemon serves, including head models and the parts in which a WebSocket sends them. */

/* A head model: the file, and its parts as JSON texts for the WebSocket. */
struct model {
    char *name, *title, *about; /* about: a short description; NULL: none */
    double rank;                /* ascending order; the first head is the default */
    char *voice;                /* members of speak for a voice that suits it, as JSON; NULL: any voice */
    const struct static_file *poster;   /* NULL: none */
    const struct static_file *pictures; /* set of pictures that can replace the model; NULL: none */
    const struct static_file *asset;
    struct model_part {
        char *kind, *name; /* "head", "texture" or "part" */
        char *json;
    } * parts;
    size_t part_count;
};

/* Fills name, title and parts from the JSON text. -1 with *e "bad-model" if it is no head model called
 * `name`; `file` is used in the message. */
int model_split(struct model *model, const char *name, const void *text, size_t size, const char *file,
                struct error *e);
void model_free(struct model *model);

struct heads {
    struct static_files files; /* web client, protocol documents and head files */
    struct model *list;        /* sorted by rank */
    size_t count, cap;
};

/* Loads the web folder, which may be missing (no page is served then), and models/heads/NAME.json.
 * NAME.webp beside a head is its poster, models/pictures/NAME.json its set of pictures. -1 with *e if a
 * head cannot be read. */
int heads_load(struct heads *heads, const char *web, const char *models, struct error *e);
void heads_free(struct heads *heads);

/* Returns NULL if there is no head of that name. */
const struct model *heads_find(const struct heads *heads, const char *name);

/* Sets *e "unknown-model" with similar names. field: of the message. Returns -1. */
int heads_unknown(const struct heads *heads, const char *name, const char *field, struct error *e);

/* ---- search_queue.c: queues jobs that search the library or save documents. Each client has its own line,
 * and the lines take turns, so that no client waits for all the jobs of another. The jobs run in threads of
 * lower priority than speech. ---- */

enum {
    SEARCHES_THREADS = 2, /* worker threads */
    SEARCHES_EACH = 64,   /* jobs of one client, waiting or running */
    SEARCHES_ALL = 512,   /* jobs in total, above which a client may have only SEARCHES_FEW */
    SEARCHES_FEW = 4,
    SEARCHES_MOST = 2048, /* jobs in total, above which all are refused */
};

/* A client with jobs in the queue. */
struct queue_client {
    struct coder_line line;
    struct queue_client *next;
    char key[80]; /* see struct principal */
    unsigned questions;
};

/* Initialise with zeros. */
struct search_queue {
    struct coder_pool *pool; /* NULL until the first job */
    struct queue_client *first;
    unsigned questions;
    enum error_code full; /* error when the queue is full; ERROR_NONE: "too-many-searches" */
};

/* Queues the job under the client with that key. *client is the client, valid until search_queue_done,
 * which job->done must call. -1 with *e (full, or "too-many-searches") if too many jobs wait. */
int search_queue_add(struct search_queue *queue, uv_loop_t *loop, const char *key, struct coder_job *job,
                     struct queue_client **client, struct error *e);
void search_queue_done(struct search_queue *queue, struct queue_client *client);

/* Lowers the priority of the calling thread for good. Call it from job->work. */
void search_queue_lower_priority(void);

/* Waits for the running jobs; the waiting ones are completed as cancelled. */
void search_queue_close(struct search_queue *queue);

struct api {
    struct api_options options;
    const struct pipeline *pipeline;
    struct offer_source offer;
    struct http_server *http;
    struct rooms *rooms;
    struct heads heads;
    struct client *clients; /* open WebSockets */
    uint64_t streams;       /* the last stream number assigned */
    bool ready, draining;
    const char *unavailable; /* why nothing can be spoken, now or soon; or NULL */
    struct quota quota;
    struct shared_limits *shared_limits; /* limits shared with other daemons; NULL: none */
    struct secrets secrets;              /* secrets of options.secrets that are not revoked */
    struct secrets_revoked revoked;
    struct revocations revocations;
    uint64_t trim_at; /* loop time before which malloc_trim is not called again, ms */
    struct film_jobs *films;
    struct events *events;        /* clients that follow a room over HTTP */
    struct search_queue searches; /* library searches */
    struct search_queue saves;    /* document saves; speech does not wait for them */
    struct search_queue coaches;  /* comparisons of recordings with texts */
    struct coaching *coachings;   /* such requests, latest first */
    struct search_queue reads;    /* document lists, reads and removals, which do not wait for saves */
    json_t *more_languages;       /* cached member of hello */
    const struct offer_voice *languages_of; /* voice list from which it was built */
};

/* ---- principal.c: identity and rights of a client, from its request's headers or from a token sent later
 * ---- */

struct connection;
struct http_request;

struct principal {
    struct token token; /* if no tokens are required: subject "", room "", all rights, no expiry */
    char key[80];       /* quota key of its requests: "a ADDRESS" or "s SUBJECT" */
    struct connection *connection;
};

/* Returns whether the page that sent the request may use the daemon. */
bool principal_origin_allowed(const struct api *api, const struct http_request *request);

/* Checks that the Host header is a name of the daemon. -1 with *e: "unknown-host". */
int principal_check_host(const struct api *api, const struct http_request *request, struct error *e);

/* Identifies the client by the token of the request, if there is one (Authorization: Bearer, or token= in
 * the address). -1 with *e: "bad-token", "expired-token", "revoked-token", "too-many-per-address". */
int principal_enter(struct api *api, const struct http_request *request, struct principal *principal,
                    struct error *e);

/* Switches to another token. -1 with *e as above, and the principal is unchanged. */
int principal_show(struct api *api, struct principal *principal, const char *token, struct error *e);

/* Stands for the room that the token is for, or any room. */
extern const char principal_own_room[];

/* Removes the rights if the secret or the token has been revoked. Returns whether it removed any. */
bool principal_revoke(const struct api *api, struct principal *principal);

/* Hash of the quota key, used to schedule quota keys in turn (speech_request.h); never 0. */
uint32_t principal_quota_key(const struct principal *principal);

/* Number of the connection, used to schedule the connections of one quota key in turn; never 0. */
uint32_t principal_connection(const struct principal *principal);

/* Checks a right at the current time. room NULL: no room. -1 with *e: "token-needed", "expired-token",
 * "forbidden". */
int principal_may(const struct api *api, const struct principal *principal, enum right right,
                  const char *room, struct error *e);

/* Counts a request. -1 with *e ("too-many-requests") if the limit for this minute is reached. */
int principal_ask(struct api *api, const struct principal *principal, struct error *e);

/* Checks the page's origin, the right and the request limit. right 0: only the origin. Returns false after
 * answering with an error; the caller then returns *result. */
bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result);
/* Likewise for what anyone may ask, with or without a token: a token that is sent must be valid. */
bool exchange_admits(struct exchange *x, int *result);
struct principal *
exchange_principal(struct exchange *x); /* valid once exchange_permits has granted a right */

struct api *exchange_api(const struct exchange *x);

/* messages.c: the offer as JSON; each function returns a new reference */
json_t *message_rooms(const struct api *api, const char *only); /* the room `only`; NULL or "": all rooms */
json_t *message_hello(struct api *api, const char *stream);
json_t *message_voices(const struct api *api);
json_t *message_models(const struct api *api);
json_t *message_expressions(const struct api *api);
json_t *message_health(const struct api *api);

/* client.c: WebSocket clients */
void client_accept(struct exchange *x); /* handles a request for a WebSocket */
bool clients_busy(const struct api *api);
void clients_dismiss(struct api *api, const char *reason); /* closes every client with the reason */
void clients_revoke(
    struct api *api); /* removes the rights of clients whose secret or token was revoked, and notifies them */

/* routes.c: answers an incoming request */
void routes_serve(struct exchange *x);

/* Functions that answer a request return 0, for the route to return. */

/* speech_route.c: /v1/speech, by POST or GET */
int speech_ask(struct exchange *x);
extern const struct members speech_members; /* members that it accepts */

/* Answers a request with exported speech. Zero-initialise, then set the members up to `event`. */
struct speech_answer {
    struct exchange *x;
    const struct export_format *format;
    int (*refuse)(struct exchange *x,
                  const struct error *e); /* answers with an error; NULL: exchange_error */
    void (*event)(struct exchange *x, const struct buf *bytes); /* sends the bytes as an event of a
                                                                   text/event-stream; bytes NULL: the end.
                                                                   NULL: they are the body */
    struct speech_export *speech;                               /* freed by the owner */
    bool begun;
};
/* -1 with *e, and nothing is answered. The answer must live as long as its exchange. */
int speech_answer_open(struct speech_answer *a, const struct speech_request *request, struct error *e);
void speech_answer_sent(void *answer); /* `sent` of the exchange's work, whose self begins with the answer */

/* film_routes.c: /v1/films and below */
int films_serve(struct exchange *x);
extern const struct members film_members; /* members that POST accepts */

/* coach_route.c: POST /v1/coach */
int coach_ask(struct exchange *x);
extern const struct members coach_members; /* members of its query */

/* openai_speech.c: POST /v1/audio/speech, and what its clients choose from. Both lists are the caller's. */
int openai_speech(struct exchange *x);
json_t *openai_voices(const struct api *api); /* {"voices"} */
json_t *openai_models(void);                  /* an array of models of speech */

/* Speech requested over HTTP, by the query and by the body if there is one: plain text, or a JSON object
 * that contains it. */
struct post_text {
    struct exchange *x;
    struct members known; /* accepted body members, except the text; other members of the query are ignored */
    const char *markup;   /* from the body's content type; NULL: not specified */
    bool json, bodiless;
    bool optional;  /* there need not be a text; the caller sets it after the beginning */
    json_t *object; /* the JSON body, once parsed */
};

/* Checks the body's content type and starts to expect the body. Returns -1 after answering 415; the caller
 * then returns *result. */
int post_text_begin(struct post_text *p, struct exchange *x, const struct members *known, int *result);

/* Builds the request once the body is complete. Body members override those of the query. -1 with *e. */
int post_text_request(struct post_text *p, struct speech_request *request, struct error *e);

/* Reads a member that is not a request field, from the body or else the query. Sets *found if it is present.
 * `cap` must exceed the longest valid value. -1 with *e if it is not a string. */
int post_text_member(const struct post_text *p, const char *name, char *value, size_t cap, bool *found,
                     struct error *e);
void post_text_free(struct post_text *p);

/* media_routes.c */

/* Finds a recording by name in the recordings folder and describes it in `source`. -1 with *e:
 * "unknown-media" if no folder is configured; otherwise the errors of recording_source_in. */
int media_source(const struct api *api, struct recording_source *source, const char *name, struct error *e);
int media_get(struct exchange *x); /* GET /v1/media */
int play_post(struct exchange *x); /* POST /v1/play?room= */

/* library_routes.c */
int library_get(struct exchange *x); /* GET /v1/library and below */

/* library/passage_speech.c: replaces the passage that a request names by its text, and gives those who speak
 * the voices of the work's cast. -1 with *e, which names a field of the request. */
int passage_resolve(const struct api *api, struct speech_request *request, struct error *e);

/* room_routes.c */
int room_commands(struct exchange *x, const char *room); /* POST /v1/rooms/ROOM/commands */
int room_say(struct exchange *x);                        /* POST /v1/say?room= */
int room_command(struct exchange *x,
                 const char *type); /* POST /v1/TYPE?room=: the body is the message, or empty */

/* room_is_remote returns whether another daemon leads the room in ?room=. room_forward sends that daemon a
 * command (command_pack) and answers when its reply arrives. */
bool room_is_remote(const struct exchange *x);
int room_forward(struct exchange *x, json_t *packed);

/* Returns the room in ?room=, or NULL after answering with an error; the caller then returns *result. */
struct channel *room_asked(struct exchange *x, int *result);

/* room_events.c */
int room_events(struct exchange *x); /* GET /v1/events?room= */
void room_events_revoke(struct api *api);

/* documents.c: documents kept by operators and editors, over GET, PUT and DELETE */
int scenes_serve(struct exchange *x);   /* /v1/scenes and below */
int gestures_serve(struct exchange *x); /* /v1/gestures and below */
int works_serve(struct exchange *x);    /* /v1/library/files and below */

int reports_serve(struct exchange *x); /* /v1/library/reports and below */

/* revoke.c: applies changed secrets or revocations. Clients whose secret or token was revoked lose their
 * rights and are notified. */
void rights_renew(struct api *api);

/* Replaces the secrets. Those that are missing from `secrets` are revoked on every daemon. */
void rights_replace(struct api *api, const struct secrets *secrets);
void rights_revoke_all(struct api *api, const struct revocations *all); /* `all` may be NULL */
int revoke_post(struct exchange *x);                                    /* POST /v1/revoke */

#endif
