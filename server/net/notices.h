/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands in a channel beside what is said: a question with its choices, and what the assistant behind
 * the face is doing, and whose face it is. It stays until it is replaced, and who comes later is told of it.
 */
#ifndef FACCIA_NET_NOTICES_H
#define FACCIA_NET_NOTICES_H

#include "server/base/error.h"
#include <jansson.h>

enum { NOTICE_CHOICES = 8, NOTICE_CHOICE_BYTES = 200 };

struct channel;

/* What a `choices`, a `choose` and a `state` message ask for: told to all who follow. by: who chose. -1 with
 * *e. */
int notice_choices(struct channel *channel, const json_t *message, struct error *e);
int notice_choose(struct channel *channel, const json_t *message, const char *by, struct error *e);
/* The mood of the stream; in a room all are told of it. by: who set it, or NULL. */
int notice_express(struct channel *channel, const json_t *message, const char *by, struct error *e);
/* A `mix` of the state is the mood that goes with it, as that of `express`. */
int notice_state(struct channel *channel, const json_t *message, struct error *e);

/* Feature points that the head takes; `reset`: its own again. */
int notice_calibrate(struct channel *channel, const json_t *message, struct error *e);

#endif
