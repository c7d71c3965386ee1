/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thousands of WebSocket clients (RFC 6455) in one process, cheap enough to share cores with the measured
 * daemon. Any error ends the program with a message, because the figures would be worthless.
 */
#ifndef FACCIA_BENCH_CLIENT_H
#define FACCIA_BENCH_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CLIENT_TEXT = 1, CLIENT_BINARY = 2 }; /* opcodes */

struct client {
    int fd;
    uint8_t *data; /* incomplete message */
    size_t size, cap;
    bool open;
};

struct clients {
    int epoll;
    size_t opened;
    double last; /* time of the last bytes, ms */
    void (*message)(void *ctx, struct client *client, int opcode, const uint8_t *data, size_t size);
    void *ctx;
};

double now_ms(void);
void die(const char *what);

void clients_open(struct clients *all);

/* Connects. The handshake completes later, in clients_serve. */
void client_dial(struct clients *all, struct client *client, int port, const char *path);
void client_send(struct client *client, const char *text, size_t size);

/* Waits up to ms and processes received bytes. */
void clients_serve(struct clients *all, int ms);

/* Tells whether the beginning of the message contains the text. */
bool holds(const uint8_t *data, size_t size, const char *text);

int ascending(const void *a, const void *b); /* floats, for qsort */

#endif
