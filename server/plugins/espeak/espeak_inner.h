/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_PLUGINS_ESPEAK_ESPEAK_INNER_H
#define FACCIA_PLUGINS_ESPEAK_ESPEAK_INNER_H

#include "server/voice/faccia-voice.h"

/* The spans that the engine is given: without what ends in a break before the first text, or begins with one
 * after the last. */
struct faccia_sentence es_inner_part(const struct faccia_sentence *sentence);

#endif
