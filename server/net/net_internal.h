/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the net stage share. */
#ifndef FACCIA_NET_NET_INTERNAL_H
#define FACCIA_NET_NET_INTERNAL_H

#include "server/access/quota.h"
#include "server/access/revocations.h"
#include "server/base/buf.h"
#include "server/net/askers.h"
#include "server/net/assets.h"
#include "server/net/channel.h"
#include "server/net/hold.h"
#include "server/net/http_request.h"
#include "server/net/net.h"
#include "server/net/principal.h"
#include "server/net/query.h"
#include <jansson.h>

struct net {
    struct net_options options;
    const struct pipeline *pipeline;
    struct offer_source offer;
    struct listeners *listeners;
    void (*descriptor_freed)(struct net *net, bool reserve); /* a connection has gone */
    struct assets assets;
    struct connection *open; /* all connections */
    struct connection *due;  /* see connection_later */
    unsigned connections;
    uint64_t streams, channels; /* numbers given so far */
    uint32_t numbered;          /* connections, the same */
    bool local;                 /* listens on loopback addresses only */
    bool ready, draining;
    const char *unavailable; /* why nothing can be spoken, nor soon will be; or NULL */
    struct quota quota;
    struct sharing *sharing; /* with other daemons; NULL: no */
    struct secrets secrets;  /* those of options.secrets that count */
    struct secrets_revoked revoked;
    struct revocations revocations;
    struct socket *sockets; /* all that are open */
    uint64_t trim_at;       /* loop time from which memory may be given back again, ms */
    uv_timer_t *keepalive;  /* over all connections; NULL: none */
    uv_idle_t *idle;        /* NULL: none */
    struct channel_turn *turn;
    struct transport *transport; /* that carry the connections */
    struct channel *rooms;
    unsigned room_count;
    const struct home_calls *home_calls; /* rooms are shared with other daemons; NULL: they are not */
    struct homes *homes;
    struct hold hold;
    struct events *events;                  /* clients that follow a room over HTTP */
    struct askers askers;                   /* of the library */
    struct askers savers;                   /* on shelves: speech does not wait for what they save */
    struct askers shelves;                  /* list, read and remove there, and do not wait for savers */
    unsigned works;                         /* HTTP answers that are being made */
    json_t *more_languages;                 /* of hello */
    const struct offer_voice *languages_of; /* the list from which they were found */
};

/* event_json.c */

/* Appends the event of that stream as a message. */
void event_write(struct buf *out, const struct stream_event *event, const char *stream);

/* What was sent in that text; a new reference, or NULL. */
json_t *message_read(const struct queued_message *message);

/* text_lines.c: the same as a line, for people who type. */
void event_line(struct buf *line, const struct stream_event *event);

/* Any other message as a line; nothing when it is of no use to them. */
void text_line(const json_t *message, struct buf *line);

/* event_json.c */
const char *event_name(enum stream_event_kind kind); /* its "type" */

/* message.c: JSON out of the stage's types, and back. */

/* {"type":"error","code",...} with the place; a new reference. */
json_t *message_error(const struct error *e);
json_t *message_rooms(const struct net *net, const char *only); /* NULL or "": all */
json_t *message_hello(struct net *net, const char *stream);
json_t *message_voices(const struct net *net);
json_t *message_models(const struct net *net);
json_t *message_expressions(const struct net *net);
json_t *message_health(const struct net *net);

/* Appends the object as text and drops it. */
void message_write(struct buf *out, json_t *object);

/* Where JSON could not be read. Returns -1. */
int message_bad_json(const json_error_t *why, struct error *e);

/* Sets the request's fields from the members of a speak message, or from the query of an address. */
int request_from_json(struct speech_request *request, const json_t *object, struct error *e);
json_t *request_to_json(const struct speech_request *request); /* NULL: its text is not UTF-8 */
int request_from_query(struct speech_request *request, const struct http_request *from, const char *except,
                       struct error *e);

/* live.c: what an idle and an express message ask for. -1 with *e. The mix borrows from the message. */
int live_idle(const json_t *message, const struct speech_request *defaults, uint64_t seed,
              struct idle_options *options, bool *on, struct error *e);
int live_express(const json_t *message, struct mood_request *mix, struct error *e);

/* socket.c, socket_in.c, socket_out.c: one WebSocket client. */

/* The head is the answer to the handshake. */
void socket_open(struct connection *connection, const struct http_request *request, const struct buf *head,
                 bool plain);
bool sockets_busy(const struct net *net);
void sockets_dismiss(struct net *net, const char *reason); /* closes all, with the reason */

/* keepalive.c: closes clients that take nothing, or are gone. */
void keepalive_begin(struct net *net);
void keepalive_end(struct net *net);

/* exchange.c, exchange_answer.c: one HTTP request and its answer. */

/* The session that a request came in; both are asked while it is answered. */
struct exchange_session {
    bool (*persists)(
        const struct connection *connection);        /* can it go on after an answer that is given now? */
    void (*answered)(struct connection *connection); /* all of the answer has left */
};
struct exchange *exchange_open(struct net *net, const struct http_request *request,
                               const struct exchange_session *session);
void exchange_close(struct exchange *x);
void exchange_sent(struct exchange *x);                   /* bytes have left */
bool exchange_answered(const struct exchange *x);         /* its head has been made */
bool exchange_done(const struct exchange *x);             /* all of it has been sent: close it */
bool exchange_persists(const struct exchange *x);         /* and another one may follow it */
bool exchange_ends_with_client(const struct exchange *x); /* that closes its side */
void exchange_look(struct exchange *x);                   /* from time to time */

/* What answers returns 0, for routes to pass on. */

/* An answer of known length; body is copied. */
int exchange_answer(struct exchange *x, unsigned status, const char *type, const void *body, size_t size);
int exchange_json(struct exchange *x, unsigned status, json_t *object); /* drops the object */
int exchange_error(struct exchange *x, const struct error *e);

/* With an ETag made of the body, which is copied; 304 when the client has it already. */
int exchange_tagged(struct exchange *x, const char *type, const void *body, size_t size);
/* The answer that is made next has that ETag. */
void exchange_tag(struct exchange *x, const char *tag);
int exchange_allow(struct exchange *x, unsigned status,
                   const char *methods); /* an empty answer that names the methods */

/* 308: the same address under that scheme. */
int exchange_move(struct exchange *x, const char *scheme);

/* 308: the same path with a slash at its end. */
int exchange_into_folder(struct exchange *x, const char *path);

/* An answer whose body lives as long as the net. */
int exchange_asset(struct exchange *x, const struct asset *asset);

/* An answer of unknown length, in chunks. */
int exchange_begin(struct exchange *x, const char *type);
void exchange_add(struct exchange *x, const void *data, size_t size);
void exchange_end(struct exchange *x);
size_t exchange_unsent(const struct exchange *x);

struct net *exchange_net(const struct exchange *x);

/* Something that was asked for is not acted on: the answer, which has not begun, will tell. The first few
 * count. exchange is one; it is void * to be called back. */
void exchange_warn(void *exchange, const struct error *e);
const struct error *exchange_warnings(const struct exchange *x, size_t *count);

struct principal *exchange_principal(struct exchange *x); /* once it has been permitted something */

/* Whether the client may do that; when not, it has been answered and *result is what to return. */
bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result);

/* The value of a parameter in the address, or NULL; cut when it is longer than what any good one could be. */
const char *exchange_query(const struct exchange *x, const char *name, char *value, size_t cap);
const struct http_request *exchange_request(const struct exchange *x);

/* The owner of a body that is being received or made. */
struct exchange_work {
    void (*body)(void *self, const void *data, size_t size); /* some of it has come; NULL: it is kept */
    int (*body_end)(void *self);   /* the body has come, if one is expected, and nothing was answered yet */
    void (*sent)(void *self);      /* bytes have left: more may come */
    void (*keepalive)(void *self); /* from time to time, from the answer's beginning on */
    void (*free)(void *self);
    void *self;
    bool endless; /* nobody waits for its end before the daemon stops */
    bool costly; /* is not gone on with for a client that has closed its side and may not be there any more */
};
bool exchange_streams_body(const struct exchange *x); /* its body may take as long as it likes */
void exchange_set_work(struct exchange *x, struct exchange_work work);

/* The body is kept, up to so many bytes; a longer one is answered with that error. Otherwise it is passed
 * over. */
void exchange_expect_body(struct exchange *x, size_t most, enum error_code too_long);
void exchange_take_body(struct exchange *x, const void *data, size_t size); /* what has come of it */
const struct buf *exchange_body(const struct exchange *x);
void exchange_drop_body(struct exchange *x); /* it is not needed any more */
struct exchange_work *exchange_get_work(struct exchange *x);

/* routes.c */
int routes_serve(struct exchange *x, const char *path, size_t length, int method);

/* speech_post.c: /v1/speech, by POST or GET */
int speech_ask(struct exchange *x);
extern const struct members speech_members; /* that it knows */

/* media_list.c */

/* A recording of the folder of those. -1 with *e: "unknown-media" when there is no such folder, or as
 * recording_source_in. */
int media_source(const struct net *net, struct recording_source *source, const char *name, struct error *e);
int media_get(struct exchange *x); /* GET /v1/media */

/* library_http.c */
int library_get(struct exchange *x); /* GET /v1/library and below */

/* passage_request.c */

/* Puts what a passage says into the request that names one. -1 with *e, a field of the request's. */
int passage_resolve(const struct net *net, struct speech_request *request, struct error *e);

int play_post(struct exchange *x); /* play_post.c: POST /v1/play?room= */

int room_write(struct exchange *x); /* room_write.c: POST /v1/say?room=&open=1 */

/* room_http.c */

/* The room that the address names; NULL after the answer, with *result to be returned. */
struct channel *room_asked(struct exchange *x, int *result);
void room_unheard(struct net *net, const char *room, const char *id, const struct error *e);
int room_say(struct exchange *x);    /* POST /v1/say?room= */
int room_stop(struct exchange *x);   /* POST /v1/stop?room= */
int room_pause(struct exchange *x);  /* POST /v1/pause?room= */
int room_resume(struct exchange *x); /* POST /v1/resume?room= */

/* notices_http.c: POST /v1/choices?room=, /v1/state?room=, /v1/calibrate?room= */
int room_choices(struct exchange *x);
int room_state(struct exchange *x);
int room_calibrate(struct exchange *x);

/* scenes.c: /v1/scenes and below, by GET, PUT and DELETE */
int scenes_serve(struct exchange *x);

/* editing.c: /v1/gestures, /v1/library/files and below, as those */
int gestures_serve(struct exchange *x);
int works_serve(struct exchange *x);

/* room_events.c */
int room_events(struct exchange *x); /* GET /v1/events?room= */
void room_events_revoke(struct net *net);

/* revoke.c: the secrets, or what is revoked, have changed: clients whose secret or token is gone lose their
 * rights, and are told. */
void rights_renew(struct net *net);

/* Those that come in place of the present ones: what is missing is revoked everywhere. */
void rights_replace(struct net *net, const struct secrets *secrets);

/* What is taken back counts no more from now on, for any daemon; rights_renew puts it out. */
void rights_revoke(struct net *net, const struct revoked *one);
void rights_revoke_all(struct net *net, const struct revocations *all); /* NULL: none */

/* revoke_http.c: POST /v1/revoke */
int revoke_post(struct exchange *x);

#endif
