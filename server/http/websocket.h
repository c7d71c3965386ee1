/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket (RFC 6455): its handshake, whole messages in and out, back pressure, pings and its close. */
#ifndef FACCIA_HTTP_WEBSOCKET_H
#define FACCIA_HTTP_WEBSOCKET_H

#include "server/base/error.h"
#include "server/http/message_queue.h"
#include "server/http/websocket_reader.h"

struct exchange;
struct websocket;

/* What the owner of one is told. */
struct websocket_calls {
    /* A whole message, which the owner may take over. Of one that is too long only the beginning is there. */
    void (*message)(void *owner, struct buf *message, bool binary, bool too_long);

    /* The client has broken the rules, and can still be told why before the connection closes. */
    void (*fault)(void *owner, const struct error *e);

    /* The client has closed its side: is there something that it is still to hear? Asked until it says no. */
    bool (*lingers)(void *owner);

    /* All that waited has left: there is room for more. */
    void (*drained)(void *owner);

    /* It is gone. */
    void (*free)(void *owner);
};

/* Checks the handshake, and chooses the first sub-protocol of the client's list that is among those known
 * here (NULL-terminated): *chosen is one of them, or NULL where the client has no list. What is sent before
 * websocket_use stays in line. NULL after a refusal has been answered. */
struct websocket *websocket_accept(struct exchange *x, const char *const *protocols, const char **chosen);

/* name is for the log; it lives as long as the owner. */
void websocket_use(struct websocket *ws, const struct websocket_calls *calls, void *owner, const char *name);

/* Sends the message, of which it keeps a reference. */
void websocket_send(struct websocket *ws, struct queued_message *message);

/* Sends together, and at once, when nothing is before them, so many of them; the others are for
 * websocket_send. */
size_t websocket_send_now(struct websocket *ws, struct queued_message *const *messages, size_t count);

/* What waits. */
struct message_queue *websocket_queue(struct websocket *ws);
bool websocket_all_sent(const struct websocket *ws);

/* Reads nothing, and hears nothing of what has been read, until it is let go on. */
void websocket_hold(struct websocket *ws, bool held);

/* Closes the connection when what waits has left; what follows is dropped. The reason is a literal. */
void websocket_close(struct websocket *ws, enum websocket_status status, const char *reason);
bool websocket_closing(const struct websocket *ws); /* its close is on the way: nothing more is heard */

#endif
