/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plugin's part of the configuration, a JSON object. */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_CONFIG_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_CONFIG_H

#include "server/plugins/common/espeak_voices.h"

#endif
