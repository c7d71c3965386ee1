/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A WebSocket client (RFC 6455), using libwebsockets on a libuv loop. */
#ifndef FACCIA_HTTP_WEBSOCKET_CLIENT_H
#define FACCIA_HTTP_WEBSOCKET_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct websocket_client;

/* Callbacks. They must not close the client. */
struct websocket_calls {
    void (*open)(void *ctx);
    void (*text)(void *ctx, const char *text, size_t size); /* a whole message */
    void (*lost)(void *ctx, const char *why);               /* the connection ended, or could not be opened */
};

enum { WEBSOCKET_TEXT_MOST = 1 << 20 /* bytes; a longer message ends the connection */ };

/* Passed to `lost` if the address cannot be reached. */
extern const char websocket_unreachable[];

/* url: ws:, wss:, http: or https:. token: a bearer token; NULL: none. again: reconnect when a connection
 * ends. Returns NULL if the url is invalid. */
struct websocket_client *websocket_client_new(uv_loop_t *loop, const char *url, const char *token, bool again,
                                              const struct websocket_calls *calls, void *ctx);

/* Sends a message once the connection is open. Messages are lost with the connection, and while no attempt
 * to connect is under way. */
void websocket_client_text(struct websocket_client *client, const char *text, size_t size);
void websocket_client_binary(struct websocket_client *client, const void *bytes, size_t size);

/* Bytes of messages waiting to be sent. */
size_t websocket_client_unsent(const struct websocket_client *client);

/* No callback follows. The loop must run until it is idle before the client is freed. */
void websocket_client_close(struct websocket_client *client);
void websocket_client_free(struct websocket_client *client);

#endif
