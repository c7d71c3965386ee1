/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plugin's part of the configuration, a JSON object. */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_CONFIG_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_CONFIG_H

#include "server/plugins/common/espeak_voices.h"

/* Loads the voices. "variants": names of espeak-ng's voice variants that are offered for every language. */
void es_config_voices(struct es_voices *voices, const char *config);

#endif
