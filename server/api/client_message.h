/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the client's messages, as protocol/messages.json declares them. A member that is a list or an
 * object is left to what acts on the message. */
#ifndef FACCIA_API_CLIENT_MESSAGE_H
#define FACCIA_API_CLIENT_MESSAGE_H

#include "server/base/error.h"
#include <jansson.h>

struct speech_request;

/* Whether the members of a message of that type are there, have their types and are in their ranges, but for
 * those that it shares with speak. -1 with *e "missing-field" or "bad-field". */
int client_message_check(const char *type, const json_t *message, struct error *e);

/* Reads the members that a message of that type shares with speak. -1 with *e "bad-field". */
int client_message_request(const char *type, const json_t *message, struct speech_request *request,
                           struct error *e);

#endif
