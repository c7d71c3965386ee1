/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values that are mostly sound of 16 bits, packed without loss: differences of neighbours, their high and low
 * bytes apart, deflated. Any bytes come back as they were. */
#ifndef FACCIA_CLUSTER_SOUND_PACK_H
#define FACCIA_CLUSTER_SOUND_PACK_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Appends. */
void sound_pack(const struct buf *value, struct buf *out);

/* Appends at most `most` bytes; false when it is not what sound_pack made, or more. */
bool sound_unpack(const void *data, size_t size, size_t most, struct buf *out);

#endif
