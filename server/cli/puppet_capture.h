/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records a face that another program sends by the Virtual Motion Capture protocol (protocol.vmc.info). */
#ifndef FACCIA_CLI_PUPPET_CAPTURE_H
#define FACCIA_CLI_PUPPET_CAPTURE_H

#include "protocol/fapfile.h"

/* Receives until SIGINT or SIGTERM, or for that time after the first face (0 = no limit). address:
 * "[HOST:]PORT", by default on this machine only. The caller frees out. Returns an exit code, after a message
 * unless 0. */
int puppet_capture(const char *address, double seconds, double fps, struct fapfile *out);

#endif
