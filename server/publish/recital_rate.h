/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voices of several languages may have several rates; a work has one. */
#ifndef FACCIA_PUBLISH_RECITAL_RATE_H
#define FACCIA_PUBLISH_RECITAL_RATE_H

#include "server/synthesis/media_segment.h"

/* The rate of MPEG audio (ISO 11172-3, 13818-3) that is next above, at most RECITAL_RATE_MAX. */
uint32_t recital_rate(uint32_t rate);

/* Gives the segment audio of that rate: its own is shared, so that it gets a copy where it has another. */
void recital_convert(struct media_segment *segment, uint32_t rate);

#endif
