/* SPDX-License-Identifier: GPL-3.0-or-later */
/* File descriptors: each connection needs one. */
#ifndef FACCIA_APP_DESCRIPTORS_H
#define FACCIA_APP_DESCRIPTORS_H

#include "server/http/http_server.h"

/* Raises the process's limit to what the connections need, beside the daemon's own files and its workers;
 * where it may not be raised so far, lowers the number of connections, and says so in the log. */
void descriptors_provide(struct http_options *options, unsigned workers);

#endif
