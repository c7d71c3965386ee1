/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is asked of a room, done by the daemon that speaks in it. An order is an object: `type`; `request` of
 * what is to be spoken (request_to_json); `message` of a client, of the other types; `by`, who asks; `payer`,
 * whose the request is; `asker`, by which of its connections (speech_request.h). */
#ifndef FACCIA_NET_ORDER_ACT_H
#define FACCIA_NET_ORDER_ACT_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

struct net;
struct speech_request;

/* abroad: which daemon asks (speech_request.h), 0: this one; number: that of the order among those of all
 * (homes_internal.h). The answer, as HTTP has it; a new reference. `utterance`, which HTTP has not, is the
 * number of what will be spoken. */
json_t *order_act(struct net *net, const char *room, const json_t *order, uint64_t abroad, uint64_t number,
                  unsigned *status);

/* Speaks the request to who is in the room, under the number *utterance (0: it is kept until somebody is
 * there). NULL with *e. */
json_t *order_say(struct net *net, const char *room, const struct speech_request *request,
                  uint32_t *utterance, struct error *e);

#endif
