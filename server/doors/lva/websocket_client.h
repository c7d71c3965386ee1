/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A WebSocket (RFC 6455) as its client, on a loop of libuv, by wslay: text messages come, none are sent. A
 * connection that ends is made again, later each time. */
#ifndef FACCIA_DOORS_WEBSOCKET_CLIENT_H
#define FACCIA_DOORS_WEBSOCKET_CLIENT_H

#include <stddef.h>
#include <uv.h>

struct websocket_client;

struct websocket_calls {
    void (*open)(void *ctx);
    void (*text)(void *ctx, const char *text, size_t size);
    void (*lost)(void *ctx, const char *why); /* after open, or when it could not be opened */
};

enum { WEBSOCKET_TEXT_MOST = 1 << 20 };

/* url: "ws://host:6055/path". NULL when it is none. */
struct websocket_client *websocket_client_new(uv_loop_t *loop, const char *url,
                                              const struct websocket_calls *calls, void *ctx);
/* No call comes after this. The loop has to run until it has nothing to do. */
void websocket_client_free(struct websocket_client *client);

#endif
