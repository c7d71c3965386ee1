/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_DOORS_WYOMING_INFO_H
#define FACCIA_DOORS_WYOMING_INFO_H

#include <jansson.h>

/* What the door can do, as `info` tells it. voices: those of /v1/voices, or NULL. */
json_t *wyoming_info(const json_t *voices);

#endif
