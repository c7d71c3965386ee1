/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_INNER_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_INNER_H

#include "server/voice/faccia-voice.h"

#endif
