/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calls back at the end of a turn of the loop: after timers and before polling, or after polled events. */
#ifndef FACCIA_BASE_LOOP_IDLE_H
#define FACCIA_BASE_LOOP_IDLE_H

#include <stdbool.h>
#include <uv.h>

struct loop_idle;

struct loop_idle *loop_idle_open(uv_loop_t *loop, void (*call)(void *ctx), void *ctx);

/* Turns the callback on or off; while on, it is called in every turn. */
void loop_idle_wait(struct loop_idle *idle, bool on);
bool loop_idle_waits(const struct loop_idle *idle);

/* Stops calling back. The memory is freed in a later turn of the loop. */
void loop_idle_close(struct loop_idle *idle);

#endif
