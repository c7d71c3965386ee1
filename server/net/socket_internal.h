/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of one WebSocket client share. */
#ifndef FACCIA_NET_SOCKET_INTERNAL_H
#define FACCIA_NET_SOCKET_INTERNAL_H

#include "server/net/connection.h"
#include "server/net/desks.h"
#include "server/net/net_internal.h"
#include "server/net/websocket_reader.h"

struct socket {
    struct net *net;
    struct connection *connection;
    uint64_t number;
    struct socket *next, **self; /* in the net's list */
    struct principal principal;
    char name[24];
    char called[DESK_NAME_BYTES + 1]; /* what it calls itself in its room; "" */
    bool plain;                       /* speaks TEXT_PROTOCOL */
    void (*hear)(struct socket *socket, const char *data,
                 size_t size);           /* acts on a text of the sub-protocol */
    void (*more)(struct socket *socket); /* says what comes once nothing waits to leave; NULL = nothing */
    struct follower follower;            /* of its own stream, or of a room's */
    struct speech_request defaults;      /* from the address */
    const char *asked;                   /* id of the message that is acted on; NULL: none */
    struct written *written;             /* texts that it is writing, and what it says itself */
    uint32_t voice;                      /* the utterance that it speaks itself; 0 = none */
    size_t written_count, written_cap;
    struct websocket_reader reader;
    struct buf message; /* being received */
    bool too_long;      /* its rest is being dropped */
    struct message_queue queue;
    struct queued_message *leaving;                   /* not all of it has been taken: */
    size_t left_at;                                   /* bytes of its frame that have */
    struct queued_message *pong;                      /* the answer to the last ping, while it waits */
    uint64_t last_rx;                                 /* loop time at which it said something last, ms */
    enum { PROBE_NONE, PROBE_DUE, PROBE_SENT } probe; /* the ping that asks whether it is still there */
    bool rx_paused;               /* nothing is read from a client that takes nothing, until it does */
    struct long_message *reading; /* a message that is read in another thread: what follows waits */
    struct buf unread;            /* what follows */
    const char *close_reason;     /* why the connection is to be closed */
    enum websocket_status close_status;
    enum websocket_status hangs_up; /* with which the client has closed, to be answered later */
    uint64_t hang_up_by;            /* loop time at which at the latest, ms; 0: it has not */
    bool farewell; /* the client has closed, or broken the rules: nothing more is awaited from it */
    bool closing;  /* the close frame is on its way, or has left */
    bool sending;  /* socket_go_on is at work */
    const struct model *model; /* being sent, part by part */
    size_t model_part;
};

/* socket_speak.c: where it is, what it hears, what it may have said */

/* The stream that it hears: its own, or its room's. */
struct stream *socket_stream(const struct socket *socket);

/* The room that it is in, or NULL. */
const char *socket_room(const struct socket *socket);

void socket_enter(struct socket *socket, struct channel *channel);
void socket_leave(struct socket *socket); /* the room that it is in */
/* called: what others there may know it by, or NULL. */
int socket_join(struct socket *socket, const char *room, bool watch, const char *called, struct error *e);

/* Whom others know it as: the subject of its token, what it calls itself, or the name of the connection. */
const char *socket_called(const struct socket *socket);

/* Its token is another: so may be its name, and what it may do. */
void socket_authorized(struct socket *socket);

/* How media and events are to come; NULL leaves one as it is. */
struct media_wish {
    const char *audio, *fap, *events, *kilobits;
};

/* -1 with *e. */
int socket_set_media(struct socket *socket, const struct media_wish *wish, struct error *e);

/* socket_utter.c: speaks a request, or a text with its defaults. */
void socket_speak_request(struct socket *socket, struct speech_request *request);
void socket_speak(struct socket *socket, const char *text, size_t size);

/* Whether it may have the stream do something; or say something more. -1 with *e. */
int socket_may_direct(struct socket *socket, struct error *e);
int socket_may_speak(struct socket *socket, struct error *e);

/* What it asked to be said is not: its error and its end. */
void socket_refuse(struct socket *socket, const char *id, const struct error *e);

/* socket_in.c: does what a message asks for. */
void socket_act(struct socket *socket, const json_t *message);

/* Acts on a whole message, or says why not. */
void socket_hear(struct socket *socket, bool binary);

/* Acts on a text that is JSON, or speaks one that is not. */
void socket_hear_json(struct socket *socket, const char *data, size_t size);

/* socket_long.c: reads the message, whose text it takes, in another thread. done is told it, or why it could
 * not be read. */
typedef void long_message_done(struct socket *socket, const json_t *message, const json_error_t *why,
                               const char *data, size_t size);
void socket_read_long(struct socket *socket, struct buf *message, long_message_done *done);
void socket_forget_long(struct socket *socket);

/* socket.c */
void socket_heard(struct socket *socket); /* it has said something */

/* socket_out.c */

/* Reads what comes, if nothing speaks against it. */
void socket_listen(struct socket *socket);

/* Asks whether it is still there. */
void socket_ping(struct socket *socket);

void socket_go_on(struct socket *socket); /* bytes have left */

/* Sends the message, and drops it. */
void socket_say(struct socket *socket, json_t *message);
void socket_say_text(struct socket *socket, const struct buf *text);
void socket_complain(struct socket *socket, const struct error *e);

/* A follower's deliver: in a room, a client that is too slow is moved on to the live edge; on
 * a stream of its own the stream waits for it. */
void socket_deliver(struct follower *follower, struct queued_message *const *messages, size_t count);

/* Closes the connection when what is on its way has left. The reason is a literal. */
void socket_dismiss(struct socket *socket, enum websocket_status status, const char *reason);

/* Closes it now: the client has, or has broken the rules. */
void socket_farewell(struct socket *socket, enum websocket_status status, const char *reason);

/* The answer to a ping. When pings come faster than answers leave, the last one is answered (RFC
 * 6455, 5.5.3). */
void socket_pong(struct socket *socket, const void *payload, size_t size);

/* socket_model.c: the next part goes out when the one before has left. */
void socket_send_model(struct socket *socket, const json_t *message);

/* socket_control.c, socket_face.c: messages that direct what is said, and how the face lives. */
void control_stop(struct socket *socket, const json_t *message);
void control_pause(struct socket *socket, const json_t *message);
void control_resume(struct socket *socket, const json_t *message);
void control_rate(struct socket *socket, const json_t *message);
void control_jump(struct socket *socket, const json_t *message);
void control_play(struct socket *socket, const json_t *message);
void control_idle(struct socket *socket, const json_t *message);
void control_express(struct socket *socket, const json_t *message);

/* socket_notice.c: what stands beside what is said */
void notice_offer(struct socket *socket, const json_t *message);
void notice_answer(struct socket *socket, const json_t *message);
void notice_show(struct socket *socket, const json_t *message);
void notice_fit(struct socket *socket, const json_t *message);
void notice_consent(struct socket *socket, const json_t *message);

/* socket_order.c: what is asked of a room in which another daemon speaks. False: nobody else does, and it is
 * to be done here. */
bool socket_order(struct socket *socket, const char *type, const json_t *message);
bool socket_order_speech(struct socket *socket, const struct speech_request *request);

/* socket_write.c: utterances whose text is still being written. */
void write_text(struct socket *socket, const json_t *message);
void write_flush(struct socket *socket, const json_t *message);
void write_close(struct socket *socket, const json_t *message);
void write_cancel(struct socket *socket, const json_t *message);

/* socket_voice.c: the client's own voice: begins, and goes on with each message of sound. */
void voice_begin(struct socket *socket, const json_t *message);
void voice_sound(struct socket *socket, const uint8_t *bytes, size_t size);

/* socket_written.c: which those are. On the stream that the client is on; the utterance may have ended. */
struct written {
    char *id;
    uint32_t utterance;
    uint16_t half; /* of a character, with which its text ends: surrogates.h */
};
struct written *written_find(struct socket *socket, const char *id); /* NULL: none */
void written_drop(struct socket *socket, struct written *written);

/* Whether it may begin one with that request. -1 with *e. */
int write_check(struct socket *socket, const struct speech_request *request, struct error *e);
void write_begin(struct socket *socket, const char *id, uint32_t utterance, uint16_t half);

/* It goes elsewhere: what it was writing is closed. */
void write_leave(struct socket *socket);

/* text_protocol.c: the sub-protocol for people who type. */
#define TEXT_PROTOCOL "faccia.text.v1"
void text_hear(struct socket *socket, const char *data, size_t size);

#endif
