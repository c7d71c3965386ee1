/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forwards commands for rooms that another daemon leads, or may lead. */
#ifndef FACCIA_ROOMS_SHARED_FORWARD_H
#define FACCIA_ROOMS_SHARED_FORWARD_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct rooms;
struct forward;

/* The answer in HTTP's form: its status, and the message, which is borrowed. Called once. */
typedef void (*forward_done)(void *ctx, unsigned status, const json_t *answer);

/* Returns whether commands for the room must be forwarded. If not, this daemon leads the room, or has it
 * alone. */
bool forward_needed(const struct rooms *rooms, const char *room);

/* Forwards a command (rooms_run) and releases it. done may be called before this returns; the result is
 * then NULL. */
struct forward *forward_command(struct rooms *rooms, const char *room, json_t *command, forward_done done,
                                void *ctx);

/* Drops the callback; the command itself is not cancelled. NULL is allowed. */
void forward_forget(struct forward *forward);

#endif
