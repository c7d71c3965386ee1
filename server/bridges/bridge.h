/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the bridge programs: a loop that SIGINT and SIGTERM stop cleanly, and the daemon's address. */
#ifndef FACCIA_BRIDGES_BRIDGE_H
#define FACCIA_BRIDGES_BRIDGE_H

#include "server/base/buf.h"
#include "server/bridges/remote.h"
#include <uv.h>

struct bridge_loop {
    uv_signal_t signals[2];
};

void bridge_loop_open(struct bridge_loop *bridge, uv_loop_t *loop);
/* Runs the loop until it is empty, and closes it. */
void bridge_loop_close(struct bridge_loop *loop);

/* Runs the loop until it is empty, for memory that is freed before the loop is closed. */
void bridge_loop_run(struct bridge_loop *loop);

/* Listens on "10200", "0.0.0.0:10200" or "[::]:10200", and logs the port. -1, or after a message an exit
 * status. */
int bridge_listen(uv_tcp_t *tcp, const char *program, const char *where, uv_connection_cb on_connection);

/* The daemon's address and token, from options and the environment. */

struct daemon_address {
    const char *url;
    char *token; /* NULL: none */
};

/* Reads FACCIA_URL and FACCIA_TOKEN, or uses defaults. An invalid FACCIA_TOKEN is reported and ignored: it
 * may be the daemon's secret, which must not be sent. */
void daemon_address_open(struct daemon_address *address);
void daemon_address_close(struct daemon_address *address);

/* Reads the token from the first line of a file. -1 after a message, also for an invalid token. */
int daemon_address_read_token(struct daemon_address *address, const char *file);

/* True if an assistant's answer has something to say: more than white space and emoji, which assistants do
 * not name. */
bool bridge_has_words(const char *text);

/* Makes an id for an utterance. */
void daemon_address_make_id(char *id, size_t cap);

#endif
