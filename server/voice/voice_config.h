/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices' configuration file: a JSON object with an object for each plugin that is to be told something,
 * by the plugin's name. What stands in those is for the plugins to check. */
#ifndef FACCIA_VOICE_VOICE_CONFIG_H
#define FACCIA_VOICE_VOICE_CONFIG_H

#include "server/base/error.h"

/* Reads the file for voice_pool_options.config; the caller frees it. NULL with *e ("bad-voice-config", with
 * line and column, or the field). */
char *voice_config_read(const char *path, struct error *e);

#endif
