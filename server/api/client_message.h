/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members and rights of client messages, as declared in protocol/messages.json. Lists and objects are
 * checked by the code that handles the message. */
#ifndef FACCIA_API_CLIENT_MESSAGE_H
#define FACCIA_API_CLIENT_MESSAGE_H

#include "server/access/token.h"
#include "server/base/error.h"
#include <jansson.h>

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
