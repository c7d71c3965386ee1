/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A call at the end of the loop's turn: behind what a timer brought and before the loop polls, or behind what
 * it polled. */
#ifndef FACCIA_BASE_TURN_END_H
#define FACCIA_BASE_TURN_END_H

#include <stdbool.h>
#include <uv.h>

struct turn_end;

struct turn_end *turn_end_open(uv_loop_t *loop, void (*call)(void *ctx), void *ctx);

/* From now on it is called, in each turn, or no more. */
void turn_end_wait(struct turn_end *turn_end, bool waits);
bool turn_end_waits(const struct turn_end *turn_end);

/* It is not called again. Its memory is given back when the loop has gone round. */
void turn_end_close(struct turn_end *turn_end);

#endif
