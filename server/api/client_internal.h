/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of one WebSocket client. */
#ifndef FACCIA_API_CLIENT_INTERNAL_H
#define FACCIA_API_CLIENT_INTERNAL_H

#include "server/access/token.h"
#include "server/api/api_internal.h"
#include "server/base/error.h"
#include "server/http/websocket.h"
#include "server/rooms/notices.h"

#include <jansson.h>

/* A text that the client is still writing, or its live voice, on its current stream. The utterance may
 * have ended already. */
struct open_text {
    char *id;
    uint32_t utterance;
    uint16_t half; /* high surrogate at the end of the text, or 0; see surrogates.h */
};

struct client {
    struct api *api;
    struct websocket *ws;
    uint64_t number;
    struct client *next, **self; /* in the API's list */
    struct principal principal;
    char name[24];
    char called[OBSERVER_NAME_BYTES + 1]; /* name that it gave when it joined its room, or "" */
    bool plain;                           /* uses TEXT_PROTOCOL */
    struct follower follower;             /* of its own stream or of a room */
    struct speech_request defaults;       /* set by the address */
    const char *asked;                    /* id of the message being handled; NULL: none */
    struct open_text *open;
    size_t open_count, open_cap;
    uint32_t voice;               /* utterance of its live voice; 0: none */
    struct client_ear *ears;      /* utterances being received or recognised */
    struct client_ear *ear;       /* receives binary messages; NULL: none */
    char *hearing;                /* its id, until `close`, even if it is done; NULL: none */
    struct long_message *reading; /* message being parsed in another thread, while later ones wait */
    const struct model *model;    /* head being sent part by part; NULL: none */
    size_t model_part;
    uint64_t commanded; /* the budget of room commands is spent up to this time, ns */
};

/* client.c: lifecycle, room and media settings */

struct stream *client_stream(const struct client *client); /* its own, or its room's */
const char *client_room(const struct client *client);      /* the room that it is in, or NULL */

/* Its name as shown to others: the subject of its token, else the name it gave, else the connection's
 * name. */
const char *client_called(const struct client *client);

/* Commands that act on the client itself. */
void client_join(struct client *client, const json_t *message);
void client_leave_room(struct client *client, const json_t *message);
void client_choose_media(struct client *client, const json_t *message);
void client_authorize(struct client *client, const json_t *message);
void client_idle(struct client *client, const json_t *message);
void client_pong(struct client *client, const json_t *message);
void client_overhear(struct client *client, const json_t *message);
void client_send_model(struct client *client, const json_t *message);

/* Sends the message and releases it. Clients of the text protocol get lines. */
void client_say(struct client *client, json_t *message);
void client_complain(struct client *client, const struct error *e);

/* Reports a refused utterance: its error and its end. `id` may be NULL. */
void client_refuse(struct client *client, const char *id, const struct error *e);

/* client_messages.c: parses incoming messages and acts on them */

void client_hear(struct client *client, struct buf *message, bool binary, bool too_long);
void client_forget_reading(struct client *client); /* abandons the message being parsed in another thread */

/* Runs the command of a message. */
void client_act(struct client *client, const json_t *message);

/* Speaks a text with the client's defaults. */
void client_speak(struct client *client, const char *text, size_t size);

/* client_speech.c: unfinished texts and the live voice */

void open_text_add(struct client *client, const json_t *message);
void open_text_flush(struct client *client, const json_t *message);
void open_text_close(struct client *client, const json_t *message);
void client_voice_begin(struct client *client, const json_t *message);
void client_voice_sound(struct client *client, const uint8_t *bytes, size_t size);

/* Reads codec, rate and channels of a voice or hear message. -1 with *e. */
struct live_request;
int client_sound_format(struct live_request *request, const json_t *message, struct error *e);

/* Closes the live voice or the utterance that binary messages are for: they do not name it. */
void client_sound_close(struct client *client);

/* Checks whether the client may begin an unfinished text with that request. -1 with *e. */
int open_text_check(struct client *client, const struct speech_request *request, struct error *e);
void open_text_begin(struct client *client, const char *id, uint32_t utterance, uint16_t half);

/* Closes its unfinished texts, because the client leaves its stream. */
void open_texts_leave(struct client *client);

/* client_ear.c: utterances to be recognised */

struct client_ear;
void client_ear_begin(struct client *client, const json_t *message);

/* Takes a binary message. False: it is not for an ear. */
bool client_ear_sound(struct client *client, const uint8_t *bytes, size_t size);

/* False: no utterance of that id is being heard. */
bool client_ear_close(struct client *client, const char *id);
void client_ear_end(struct client *client);    /* closes the ear that receives sound */
void client_ears_leave(struct client *client); /* drops all, because the client leaves its stream */

/* client_drive.c: frames of a face that the client drives */
void client_drive(struct client *client, const json_t *message);
void client_drive_leave(struct client *client); /* ends the driving, because the client leaves its stream */

/* text_protocol.c: the sub-protocol for typing */
#define TEXT_PROTOCOL "faccia.text.v1"
void text_hear(struct client *client, const char *data, size_t size);

/* Members and rights of client messages, as declared in protocol/messages.json. Lists and objects are
 * checked by the code that handles the message. */

struct speech_request;

/* The right that messages of that type need; 0: none, or no such type. */
enum right client_message_right(const char *type);

/* Checks that required members are present, and that all members have valid types and ranges. Members
 * shared with speak are not checked. -1 with *e "missing-field" or "bad-field". */
int client_message_check(const char *type, const json_t *message, struct error *e);

/* Reads the members that messages of that type share with speak. -1 with *e "bad-field". */
int client_message_request(const char *type, const json_t *message, struct speech_request *request,
                           struct error *e);

#endif
