/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Commands for a room that another daemon leads, or may lead. */
#ifndef FACCIA_ROOMS_SHARED_FORWARD_H
#define FACCIA_ROOMS_SHARED_FORWARD_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct rooms;
struct forward;

/* The answer as that of HTTP: its status, and the message, borrowed. Comes once. */
typedef void (*forward_done)(void *ctx, unsigned status, const json_t *answer);

/* Must commands for that room be forwarded? When not, this daemon leads the room, or has it alone. */
bool forward_needed(const struct rooms *rooms, const char *room);

/* Forwards the command (rooms_run), which it releases. done may be called at once: then NULL is returned. */
struct forward *forward_command(struct rooms *rooms, const char *room, json_t *command, forward_done done,
                                void *ctx);

/* No answer is wanted any more. NULL is fine. */
void forward_forget(struct forward *forward);

#endif
