/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands that clients give: one table for WebSocket messages, lines that people type, HTTP requests and
 * what other daemons forward. A command acts on a room or on a stream of one's own; some act on the WebSocket
 * client that gives them, and can be given by no one else. */
#ifndef FACCIA_API_COMMANDS_H
#define FACCIA_API_COMMANDS_H

#include "server/access/token.h"
#include "server/base/error.h"
#include "server/synthesis/speech_request.h"
#include <jansson.h>
#include <stdbool.h>

struct api;
struct channel;
struct client;
struct principal;

/* Who gives a command, and on what it acts. */
struct command_call {
    struct api *api;
    const char *room;               /* NULL: a stream of one's own */
    struct channel *channel;        /* of the room, or the stream; NULL: nobody is in the room */
    const json_t *message;          /* as the client sent it; NULL: nothing but its type */
    struct speech_request *request; /* of commands that speak */
    const char *by;                 /* the client's name, "" = none */
    bool observes;                  /* the client only looks on in the room */
    bool keeps;                     /* what is said to an empty room is kept for a while, where that is set */
    /* what the command leaves */
    unsigned status; /* of the answer over HTTP */
    json_t *answer;
    uint32_t utterance; /* of a command that speaks: its number; 0: refused, or kept */
};

struct command {
    const char *name; /* the "type" of its message */
    enum right right; /* that it needs; 0: being in the room is enough */
    bool speaks;      /* has the members of a request, counts as one, and its refusal is told as its end */
    bool bare;        /* its message has nothing but its type */
    int (*check)(const struct command_call *call, bool *exempt, struct error *e); /* see command_permit */
    int (*run)(struct command_call *call, struct error *e);    /* on a room or a stream; -1 with *e */
    void (*act)(struct client *client, const json_t *message); /* in place of run: on the client itself */
};

/* NULL: there is none of that name. */
const struct command *command_find(const char *name);

/* The same; when there is none, *e says which is near ("unknown-type"). */
const struct command *command_of(const json_t *message, struct error *e);

/* Reads what is to be spoken out of the message: all members of a request, or those that the command shares
 * with speak. -1 with *e "bad-field". */
int command_request(const struct command *command, const json_t *message, struct speech_request *request,
                    struct error *e);

/* May who gives it do that in the room of the call? -1 with *e. */
int command_permit(const struct command *command, const struct command_call *call,
                   const struct principal *principal, struct error *e);

/* What is to be spoken, and by whom it is asked: its limits are checked and its passage is looked up.
 * -1 with *e. */
int command_admit(const struct command_call *call, const struct principal *principal, struct error *e);

/* Checks the members of its message, and runs it here. -1 with *e; else call->answer is a new reference,
 * which the caller releases. */
int command_run(const struct command *command, struct command_call *call, struct error *e);

/* The same as an object for the daemon that leads the room: rooms_run. NULL with *e. */
json_t *command_pack(const struct command *command, const struct command_call *call, struct error *e);

/* rooms_run: ctx is the api. */
json_t *commands_run_packed(void *ctx, const char *room, const json_t *command, uint64_t remote,
                            uint64_t number, unsigned *status);

#endif
