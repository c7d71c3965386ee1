/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens the library of the settings: its index, and its recordings as voices. */
#ifndef FACCIA_DAEMON_LIBRARY_SETUP_H
#define FACCIA_DAEMON_LIBRARY_SETUP_H

#include "server/daemon/settings.h"
#include "server/library/library.h"

/* *library is NULL when none is configured. *voice_config is the configuration of voice plugins including
 * the recordings; free it; NULL: unchanged. -1 with *e. */
int library_setup_open(const struct settings *settings, const struct paths *paths, struct library **library,
                       char **voice_config, struct error *e);

/* Sets up the voices only, for a command. */
int library_setup_voices(const struct settings *settings, char **voice_config, struct error *e);

#endif
