/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Client commands: one table for WebSocket messages, typed lines, HTTP requests and commands forwarded by
 * other daemons. A command acts on a room or on the client's own stream. Some act on the WebSocket client
 * itself and are available only there. */
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

/* One invocation of a command: its client and its target. */
struct command_call {
    struct api *api;
    const char *room;               /* NULL: the client's own stream */
    struct channel *channel;        /* of the room or the stream; NULL: the room is empty */
    const json_t *message;          /* as the client sent it; NULL: it has only its type */
    struct speech_request *request; /* for commands that speak */
    const char *by;                 /* the client's name; "": none */
    bool observes;                  /* the client is an observer of the room */
    bool keeps;                     /* hold speech for an empty room for a while, where that is configured */
    /* results of the command */
    unsigned status; /* HTTP status */
    json_t *answer;
    bool asks;          /* a question waits for its answer */
    uint32_t utterance; /* number of the utterance, for commands that speak; 0: refused, or held */
};

struct command {
    const char *name; /* "type" of its message */
    bool speaks; /* takes a speech request, counts against the request limit, and reports a refusal as the
                    utterance's end */
    bool bare;   /* its message has no member but the type */
    int (*check)(const struct command_call *call, bool *exempt, struct error *e); /* see command_permit */
    int (*run)(struct command_call *call, struct error *e);    /* acts on a room or a stream; -1 with *e */
    void (*act)(struct client *client, const json_t *message); /* acts on the client itself; replaces `run` */
};

/* Returns NULL if no command has that name. */
const struct command *command_find(const char *name);

/* Finds the command for a message. NULL with *e: "unknown-type" with similar names, or "bad-message" if
 * the message has no type. */
const struct command *command_of(const json_t *message, struct error *e);

/* Reads the speech request from a message: all members for speak, else those that the command shares with
 * speak. -1 with *e "bad-field". */
int command_request(const struct command *command, const json_t *message, struct speech_request *request,
                    struct error *e);

/* Checks whether the principal may run the command in the room of the call. -1 with *e. */
int command_permit(const struct command *command, const struct command_call *call,
                   const struct principal *principal, struct error *e);

/* Admits a speech request: checks its limits, looks up its passage and records who asks. -1 with *e. */
int command_admit(const struct command_call *call, const struct principal *principal, struct error *e);

/* Checks the members of the message and runs the command on this daemon. -1 with *e; otherwise
 * call->answer is a new reference, which the caller releases. */
int command_run(const struct command *command, struct command_call *call, struct error *e);

/* Serialises a call for the daemon that leads the room: see rooms_run. NULL with *e. */
json_t *command_pack(const struct command *command, const struct command_call *call, struct error *e);

/* Runs a command from command_pack. Implements rooms_run; ctx is the api. */
json_t *commands_run_packed(void *ctx, const char *room, const json_t *command, uint64_t remote,
                            uint64_t number, unsigned *status);

#endif
