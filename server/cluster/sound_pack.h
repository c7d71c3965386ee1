/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lossless compression for values that are mostly 16-bit sound: differences of neighbouring samples, high
 * and low bytes apart, deflated. Works for any bytes. */
#ifndef FACCIA_CLUSTER_SOUND_PACK_H
#define FACCIA_CLUSTER_SOUND_PACK_H

#include "server/base/buf.h"
#include <stdbool.h>

/* Appends the packed value to out. */
void sound_pack(const struct buf *value, struct buf *out);

/* Appends at most `most` bytes. Returns false when the data was not made by sound_pack, or is larger. */
bool sound_unpack(const void *data, size_t size, size_t most, struct buf *out);

#endif
