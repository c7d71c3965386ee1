/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of one WebSocket client share. */
#ifndef FACCIA_API_CLIENT_INTERNAL_H
#define FACCIA_API_CLIENT_INTERNAL_H

#include "server/api/api_internal.h"
#include "server/http/websocket.h"
#include "server/rooms/notices.h"

/* A text that the client is writing, or its own voice. On the stream that the client is on; the utterance may
 * have ended. */
struct open_text {
    char *id;
    uint32_t utterance;
    uint16_t half; /* of a character, with which its text ends: surrogates.h */
};

struct client {
    struct api *api;
    struct websocket *ws;
    uint64_t number;
    struct client *next, **self; /* in the api's list */
    struct principal principal;
    char name[24];
    char called[OBSERVER_NAME_BYTES + 1]; /* what it calls itself in its room; "" */
    bool plain;                           /* speaks TEXT_PROTOCOL */
    struct follower follower;             /* of its own stream, or of a room's */
    struct speech_request defaults;       /* from the address */
    const char *asked;                    /* id of the message that is acted on; NULL: none */
    struct open_text *open;
    size_t open_count, open_cap;
    uint32_t voice;               /* the utterance that it speaks itself; 0 = none */
    struct long_message *reading; /* a message that is read in another thread: what follows waits */
    const struct model *model;    /* being sent, part by part; NULL: none */
    size_t model_part;
};

/* client.c: how it comes and goes, where it is, what it hears */

struct stream *client_stream(const struct client *client); /* its own, or its room's */
const char *client_room(const struct client *client);      /* that it is in, or NULL */

/* Whom others know it as: the subject of its token, what it calls itself, or the name of the connection. */
const char *client_called(const struct client *client);

/* Commands that act on the client itself. */
void client_join(struct client *client, const json_t *message);
void client_leave_room(struct client *client, const json_t *message);
void client_choose_media(struct client *client, const json_t *message);
void client_authorize(struct client *client, const json_t *message);
void client_idle(struct client *client, const json_t *message);
void client_pong(struct client *client, const json_t *message);
void client_send_model(struct client *client, const json_t *message);

/* Sends the message, which it releases. People who type get lines. */
void client_say(struct client *client, json_t *message);
void client_complain(struct client *client, const struct error *e);

/* What it asked to be said is not: its error and its end. id NULL: it has none. */
void client_refuse(struct client *client, const char *id, const struct error *e);

/* client_messages.c: what it sends, taken apart and acted on */

void client_hear(struct client *client, struct buf *message, bool binary, bool too_long);
void client_forget_reading(struct client *client); /* what is read in another thread */

/* Does what a message asks for. */
void client_act(struct client *client, const json_t *message);

/* Speaks a text with the client's defaults. */
void client_speak(struct client *client, const char *text, size_t size);

/* client_speech.c: utterances that it is writing, or speaks itself */

void open_text_add(struct client *client, const json_t *message);
void open_text_flush(struct client *client, const json_t *message);
void open_text_close(struct client *client, const json_t *message);
void client_voice_begin(struct client *client, const json_t *message);
void client_voice_sound(struct client *client, const uint8_t *bytes, size_t size);

/* Whether it may begin one with that request. -1 with *e. */
int open_text_check(struct client *client, const struct speech_request *request, struct error *e);
void open_text_begin(struct client *client, const char *id, uint32_t utterance, uint16_t half);

/* It goes elsewhere: what it was writing is closed. */
void open_texts_leave(struct client *client);

/* text_protocol.c: the sub-protocol for people who type */
#define TEXT_PROTOCOL "faccia.text.v1"
void text_hear(struct client *client, const char *data, size_t size);

#endif
