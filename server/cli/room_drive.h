/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drives the face of a room in a running daemon with faces as they come (protocol/README.md, "Driving"). */
#ifndef FACCIA_CLI_ROOM_DRIVE_H
#define FACCIA_CLI_ROOM_DRIVE_H

#include "server/cli/puppet_packet.h"
#include <stdbool.h>
#include <uv.h>

struct room_drive;

/* url: of the daemon; token_file: with its token. NULL: as the environment tells. Waits for the connection.
 * NULL after a message. */
struct room_drive *room_drive_open(uv_loop_t *loop, const char *room, const char *url,
                                   const char *token_file);

/* Sends a face, or soon with those that follow; drops it if the connection is too slow. The drive stops the
 * loop if the daemon refuses it or is gone. */
void room_drive_face(void *drive, const struct puppet_face *face, double time);

/* Runs the loop until it is empty. Returns whether all went well; otherwise there has been a message. */
bool room_drive_close(struct room_drive *drive);

#endif
