/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One WebSocket (RFC 6455): handshake, whole messages in both directions, back pressure, pings and close. */
#ifndef FACCIA_HTTP_WEBSOCKET_H
#define FACCIA_HTTP_WEBSOCKET_H

#include "server/base/error.h"
#include "server/http/message_queue.h"
#include "server/http/websocket_reader.h"

struct exchange;
struct websocket;

/* Callbacks of the owner. */
struct websocket_calls {
    /* A whole message has arrived; the owner may take the buffer over. If it is too long, only its
     * beginning is present. */
    void (*message)(void *owner, struct buf *message, bool binary, bool too_long);

    /* The client has violated the protocol. It can still be told why before the connection closes. */
    void (*fault)(void *owner, const struct error *e);

    /* The client has closed its side. Returns whether it must still receive something; called until it
     * returns false. */
    bool (*lingers)(void *owner);

    /* The queue has been sent: there is room for more. */
    void (*drained)(void *owner);

    /* The WebSocket is gone. */
    void (*free)(void *owner);
};

/* Checks the handshake and picks the first sub-protocol of the client's list that is in `protocols`
 * (NULL-terminated). *chosen is one of them, or NULL if the client sent no list. Messages sent before
 * websocket_use are queued. Returns NULL after answering with a refusal. */
struct websocket *websocket_accept(struct exchange *x, const char *const *protocols, const char **chosen);

/* name is for the log and must live as long as the owner. */
void websocket_use(struct websocket *ws, const struct websocket_calls *calls, void *owner, const char *name);

/* Sends the message, adding a reference. */
void websocket_send(struct websocket *ws, struct queued_message *message);

/* Sends messages together and at once if none are queued before them. Returns how many; pass the others to
 * websocket_send. */
size_t websocket_send_now(struct websocket *ws, struct queued_message *const *messages, size_t count);

/* The messages waiting to be sent. */
struct message_queue *websocket_queue(struct websocket *ws);
bool websocket_all_sent(const struct websocket *ws);

/* Stops reading and delivering messages until called with false. */
void websocket_hold(struct websocket *ws, bool held);

/* Closes the connection once the queue has been sent; later messages are dropped. The reason is a string
 * literal. */
void websocket_close(struct websocket *ws, enum websocket_status status, const char *reason);
bool websocket_closing(
    const struct websocket *ws); /* its close frame is being sent: no more messages are delivered */

#endif
