/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the net stage share. */
#ifndef FACCIA_NET_INTERNAL_H
#define FACCIA_NET_INTERNAL_H

#include "server/access/tally.h"
#include "server/base/buf.h"
#include "server/net/assets.h"
#include "server/net/channel.h"
#include "server/net/guest.h"
#include "server/net/net.h"
#include <jansson.h>
#include <libwebsockets.h>

struct net {
    struct net_options options;
    const struct studio *studio;
    struct lws_context *context;
    struct lws_vhost *vhost;
    struct assets assets;
    unsigned connections;
    uint64_t streams; /* numbers given so far */
    bool ready, draining;
    struct tally tally;
    struct listener **listeners;
    struct socket *sockets;     /* all that are open */
    struct exchange *exchanges; /* likewise */
    uv_timer_t *watch;          /* over both; NULL: none */
    struct channel *rooms;
    unsigned room_count;
    unsigned works;                   /* HTTP answers that are being made */
    json_t *more_languages;           /* of hello */
    const struct voice *languages_of; /* the list from which they were found */
};

/* What libwebsockets keeps for each connection: one of the two. */
struct session {
    struct socket *socket;
    struct exchange *exchange;
};

int net_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size);

/* event_json.c */

/* Appends the event of that stream as a message. */
void event_write(struct buf *out, const struct stream_event *event, const char *stream);
const char *event_name(enum stream_event_kind kind); /* its "type" */

/* message.c: JSON out of the stage's types, and back. */

/* {"type":"error","code",...} with the place; a new reference. */
json_t *message_error(const struct error *e);
json_t *message_rooms(const struct net *net);
json_t *message_hello(struct net *net, const char *stream);
json_t *message_voices(const struct net *net);
json_t *message_models(const struct net *net);
json_t *message_expressions(const struct net *net);
json_t *message_health(const struct net *net);

/* Appends the object as text and drops it. */
void message_write(struct buf *out, json_t *object);

/* Sets the request's fields from the members of a speak message, or from the query of an address. */
int request_from_json(struct speech_request *request, const json_t *object, struct error *e);
int request_from_query(struct speech_request *request, struct lws *wsi, const char *except, struct error *e);

/* live.c: what an idle and an express message ask for. -1 with *e. The mix borrows from the message. */
int live_idle(const json_t *message, const struct speech_request *defaults, uint64_t seed,
              struct idle_options *options, bool *on, struct error *e);
int live_express(const json_t *message, struct stream_mix *mix, struct error *e);

/* socket.c, socket_in.c, socket_out.c: one WebSocket client. */
struct socket *socket_open(struct net *net, struct lws *wsi);
void socket_close(struct socket *socket);
int socket_receive(struct socket *socket, const char *data, size_t size);
int socket_writeable(struct socket *socket);
bool sockets_busy(const struct net *net);
void sockets_dismiss(struct net *net, const char *reason); /* closes all, with the reason */

/* watch.c: closes clients that take nothing, or are gone. */
void watch_begin(struct net *net);
void watch_end(struct net *net);
/* Cuts off one who has taken nothing since `progress` (loop time, ms) though bytes wait, when that is too
 * long ago. True: done. */
bool watch_stalled(struct net *net, struct lws *wsi, const char *name, uint64_t progress);
void socket_heard(struct socket *socket); /* he has said something */

/* exchange.c, exchange_answer.c: one HTTP request and its answer. Every function returns what the
 * libwebsockets callback has to return. */
struct exchange *exchange_open(struct net *net, struct lws *wsi);
void exchange_close(struct exchange *x);
int exchange_writeable(struct exchange *x);
bool exchange_answered(const struct exchange *x); /* its head has been sent */
bool exchange_done(const struct exchange *x);     /* all of it has been sent: close it */
void exchanges_look(struct net *net);             /* from time to time, after all of them */

/* An answer of known length; body is copied. */
int exchange_answer(struct exchange *x, unsigned status, const char *type, const void *body, size_t size);
int exchange_json(struct exchange *x, unsigned status, json_t *object); /* drops the object */
int exchange_error(struct exchange *x, unsigned status, const struct error *e);
int exchange_allow(struct exchange *x, unsigned status,
                   const char *methods); /* an empty answer that names the methods */

/* An answer whose body lives as long as the net. */
int exchange_asset(struct exchange *x, const struct asset *asset);

/* An answer of unknown length, in chunks. */
int exchange_begin(struct exchange *x, const char *type);
void exchange_add(struct exchange *x, const void *data, size_t size);
void exchange_end(struct exchange *x);
size_t exchange_unsent(const struct exchange *x);

struct net *exchange_net(const struct exchange *x);

/* Whether he who asks may do that; when not, it has been answered and *result is what to return. */
bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result);

/* The value of a parameter in the address, or NULL. */
const char *exchange_query(const struct exchange *x, const char *name, char *value, size_t cap);
struct lws *exchange_wsi(const struct exchange *x);

/* The owner of a body that is being received or made. */
struct exchange_work {
    int (*body)(void *self, const void *data, size_t size);
    int (*body_end)(void *self);
    void (*sent)(void *self); /* bytes have left: more may come */
    void (*beat)(void *self); /* from time to time, from the answer's beginning on */
    void (*free)(void *self);
    void *self;
    bool endless; /* nobody waits for its end before the daemon stops */
};
void exchange_set_work(struct exchange *x, struct exchange_work work);
struct exchange_work *exchange_get_work(struct exchange *x);

/* listen.c */
void listeners_open(struct net *net);
void listeners_close(struct net *net);

/* routes.c */
int routes_serve(struct exchange *x, const char *path, size_t length, int method);

/* speech_post.c: POST /v1/speech */
int speech_post(struct exchange *x);

/* What the body of a POST is, from its Content-Type: the name of a markup, or NULL after the answer 415, with
 * *result to be returned. */
const char *post_markup(struct exchange *x, int *result);

/* media.c */

/* A recording of the folder of those. -1 with *e: "unknown-media" when there is no such folder, or as
 * reel_source_in. */
int media_source(const struct net *net, struct reel_source *source, const char *name, struct error *e);
int media_get(struct exchange *x); /* GET /v1/media */

int play_post(struct exchange *x); /* play_post.c: POST /v1/play?room= */

/* room_http.c */

/* The room that the address names; NULL after the answer, with *result to be returned. */
struct channel *room_asked(struct exchange *x, int *result);
int room_say(struct exchange *x);    /* POST /v1/say?room= */
int room_stop(struct exchange *x);   /* POST /v1/stop?room= */
int room_pause(struct exchange *x);  /* POST /v1/pause?room= */
int room_resume(struct exchange *x); /* POST /v1/resume?room= */
int room_events(struct exchange *x); /* GET /v1/events?room= */

#endif
