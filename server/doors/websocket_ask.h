/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a client asks for a WebSocket, and whether the answer is one (RFC 6455, 4). */
#ifndef FACCIA_DOORS_WEBSOCKET_ASK_H
#define FACCIA_DOORS_WEBSOCKET_ASK_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <wslay/wslay.h>

enum { WEBSOCKET_ANSWER_BYTES = 64, WEBSOCKET_HEAD_MOST = 16384 };

/* Writes the request. answer: what the server has to give; token: NULL = none. */
void websocket_ask(struct buf *head, const char *host, const char *path, const char *token,
                   char answer[WEBSOCKET_ANSWER_BYTES]);
/* head: the lines of the response, with a NUL at the end. */
bool websocket_answered(const char *head, const char *answer);

/* What masks the frames: a callback of wslay. */
int websocket_mask(wslay_event_context_ptr frames, uint8_t *mask, size_t size, void *ctx);

#endif
