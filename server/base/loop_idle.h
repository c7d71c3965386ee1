/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A call at the end of the loop's turn: behind what a timer brought and before the loop polls, or behind what
 * it polled. */
#ifndef FACCIA_BASE_TURN_END_H
#define FACCIA_BASE_TURN_END_H

#include <stdbool.h>
#include <uv.h>

struct loop_idle;

struct loop_idle *loop_idle_open(uv_loop_t *loop, void (*call)(void *ctx), void *ctx);

/* From now on it is called, in each turn, or no more. */
void loop_idle_wait(struct loop_idle *turn_end, bool waits);
bool loop_idle_waits(const struct loop_idle *turn_end);

/* It is not called again. Its memory is given back when the loop has gone round. */
void loop_idle_close(struct loop_idle *turn_end);

#endif
