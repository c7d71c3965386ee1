/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A WebSocket (RFC 6455) as its client, by libwebsockets on a loop of libuv. */
#ifndef FACCIA_HTTP_WEBSOCKET_CLIENT_H
#define FACCIA_HTTP_WEBSOCKET_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct websocket_client;

/* None of them may close it. */
struct websocket_calls {
    void (*open)(void *ctx);
    void (*text)(void *ctx, const char *text, size_t size); /* a whole message */
    void (*lost)(void *ctx, const char *why);               /* after open, or when it could not be opened */
};

enum { WEBSOCKET_TEXT_MOST = 1 << 20 /* bytes; a longer message ends the connection */ };

/* What `lost` says when there is nobody at that address. */
extern const char websocket_unreachable[];

/* url: ws:, wss:, http: or https:. token: a bearer's; NULL: none. again: a connection that ends is made
 * again. NULL when the url is none. */
struct websocket_client *websocket_client_new(uv_loop_t *loop, const char *url, const char *token, bool again,
                                              const struct websocket_calls *calls, void *ctx);

/* Sends a message, once there is a connection; what waits goes with the connection. */
void websocket_client_text(struct websocket_client *client, const char *text, size_t size);
void websocket_client_binary(struct websocket_client *client, const void *bytes, size_t size);

/* Bytes of messages that wait. */
size_t websocket_client_unsent(const struct websocket_client *client);

/* No call comes after it. The loop must run until it has nothing to do before the client is freed. */
void websocket_client_close(struct websocket_client *client);
void websocket_client_free(struct websocket_client *client);

#endif
