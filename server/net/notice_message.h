/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages that are no events of a stream, as they are told to those who follow it. */
#ifndef FACCIA_NET_NOTICE_MESSAGE_H
#define FACCIA_NET_NOTICE_MESSAGE_H

#include "server/base/error.h"
#include "server/net/channel_internal.h"
#include <jansson.h>

/* The message so far, to which its members are added. */
json_t *notice_begin(const struct channel *channel, const char *type);

/* Takes a member over, if it is there. */
void notice_take_member(const json_t *message, const char *name, json_t *into);

/* The message as it is sent. event: its type, a literal. The reference is the caller's. */
struct queued_message *notice_message(const json_t *told, const char *event);

/* Tells all who follow. @return the message, whose reference is the caller's */
struct queued_message *notice_tell(struct channel *channel, const json_t *told, const char *event);

#endif
