/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The head of a command's --model. */
#ifndef FACCIA_CLI_CLI_HEAD_H
#define FACCIA_CLI_CLI_HEAD_H

#include "server/base/buf.h"
#include "server/daemon/settings.h"
#include "server/synthesis/speech_request.h"
#include <jansson.h>
#include <limits.h>

/* Finds the file of the head: a name, or a file if it has a slash or ends in .json; the first by rank if it
 * is NULL. option: named in messages. Returns the head, or NULL after a message.
 */
json_t *cli_head_find(const struct settings *settings, const char *option, const char *name,
                      char file[PATH_MAX]);

/* Sets `file` to the set of pictures that shows the head. -1 after a message. */
int cli_head_pictures(const struct settings *settings, const json_t *head, char file[PATH_MAX]);

/* -1 after a message, unless the file is a set of pictures. */
int cli_pictures_check(const char *option, const char *file);

/* Unless the request names a voice: asks for the voice that suits the head, as a page does. */
void cli_head_suit(struct speech_request *request, const json_t *head);

/* Appends the head of that file, compressed by gzip. -1 after a message. */
int cli_head_pack(const char *file, struct buf *out);

#endif
