/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which files the operator allows a plugin, by its configuration. */
#ifndef FACCIA_VOICE_PLUGIN_ALLOWED_H
#define FACCIA_VOICE_PLUGIN_ALLOWED_H

#include "server/voice/sandbox.h"

struct allowed {
    struct sandbox_path *paths;
    size_t count, cap;
    char *config; /* what is left for the plugin */
};

/* Whatever absolute path stands in the configuration is allowed: a folder with all that is in it, to be
 * written to as well, and of a file the folder that it lies in, as programs and models have other files
 * beside them; but of one in /, /etc, /tmp, /var/tmp, /run or the user's home folder that file alone. The
 * members "may_read" and "may_write", lists of further paths, are taken out. -1 with a sentence in message.
 */
int allowed_read(struct allowed *allowed, const char *config, char *message, size_t cap);

/* The language packs may be read, wherever they are installed. */
void allowed_add_packs(struct allowed *allowed);

void allowed_free(struct allowed *allowed);

#endif
