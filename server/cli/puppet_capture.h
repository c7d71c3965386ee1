/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Receives a face that another program sends by UDP, records it, and hands it on as it comes. */
#ifndef FACCIA_CLI_PUPPET_CAPTURE_H
#define FACCIA_CLI_PUPPET_CAPTURE_H

#include "protocol/fapfile.h"
#include "server/cli/puppet_packet.h"
#include <stdbool.h>
#include <uv.h>

struct puppet_capture {
    const char *address; /* "[HOST:]PORT", by default on this machine only */
    const char *phone;   /* "HOST[:PORT]" with a numeric address, asked for its face; NULL: nobody is asked */
    double seconds;      /* to receive after the first face; 0: until SIGINT or SIGTERM */
    double fps;          /* of the recording */
    bool record;
    /* Receives each face, with its time in s from the first. NULL: nobody does. */
    void (*face)(void *ctx, const struct puppet_face *face, double time);
    void *ctx;
};

/* Receives on a loop, until its time is over, a signal comes, or uv_stop. The caller frees out, which is set
 * if something is recorded, and closes the loop. Returns an exit code, after a message unless 0. */
int puppet_capture(uv_loop_t *loop, const struct puppet_capture *capture, struct fapfile *out);

#endif
