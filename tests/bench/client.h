/* SPDX-License-Identifier: GPL-3.0-or-later */
/* WebSocket clients (RFC 6455) by the thousand in one process, cheap enough to share the cores with the
 * daemon that is measured. What goes wrong ends the program with a message: the figures would be worthless.
 */
#ifndef FACCIA_BENCH_CLIENT_H
#define FACCIA_BENCH_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CLIENT_TEXT = 1, CLIENT_BINARY = 2 }; /* opcodes */

struct client {
    int fd;
    uint8_t *data; /* what came and is no whole message yet */
    size_t size, cap;
    bool open;
};

struct clients {
    int epoll;
    size_t opened;
    double last; /* when bytes came last, ms */
    void (*message)(void *ctx, struct client *client, int opcode, const uint8_t *data, size_t size);
    void *ctx;
};

double now_ms(void);
void die(const char *what);

void clients_open(struct clients *all);

/* Connects; the handshake is answered later. */
void client_dial(struct clients *all, struct client *client, int port, const char *path);
void client_send(struct client *client, const char *text, size_t size);

/* Waits so many ms at most, and takes in what has come. */
void clients_serve(struct clients *all, int ms);

/* Does the beginning of the message hold that text? */
bool holds(const uint8_t *data, size_t size, const char *text);

int ascending(const void *a, const void *b); /* floats, for qsort */

#endif
