/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records a face that another program sends by the Virtual Motion Capture protocol (protocol.vmc.info). */
#ifndef FACCIA_CLI_PUPPET_CAPTURE_H
#define FACCIA_CLI_PUPPET_CAPTURE_H

#include "protocol/fapfile.h"
#include <stddef.h>
#include <stdint.h>

/* Receives what a packet says. */
struct puppet_sink {
    void *ctx;
    void (*weight)(void *ctx, int shape, double weight); /* of arkit_table; finite */
    void (*apply)(void *ctx);                            /* the weights are complete */
};

/* Reads a message, or a bundle of messages and bundles (OSC 1.0). Ignores what is malformed. */
void puppet_packet(const uint8_t *data, size_t size, const struct puppet_sink *sink);

/* Receives until SIGINT or SIGTERM, or for that time after the first face (0 = no limit). address:
 * "[HOST:]PORT", by default on this machine only. The caller frees out. Returns an exit code, after a message
 * unless 0. */
int puppet_capture(const char *address, double seconds, double fps, struct fapfile *out);

#endif
