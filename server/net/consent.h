/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether the listener of a room agrees that a study writes down what happens: asked by who directs the room,
 * answered by who listens. It stays until it is withdrawn, and who comes later is told of it. */
#ifndef FACCIA_NET_CONSENT_H
#define FACCIA_NET_CONSENT_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct channel;

/* Is the message an answer (`given`, `declined`), or does it ask (`asked`, `none`)? -1 with *e: neither. */
int consent_is_answer(const json_t *message, bool *answer, struct error *e);

/* Does what the message asks for, and tells all who follow. Asked again in the same words, the answer that
 * there is holds. by: who. -1 with *e ("no-choices": nothing is asked). */
int consent_take(struct channel *channel, const json_t *message, const char *by, struct error *e);

#endif
