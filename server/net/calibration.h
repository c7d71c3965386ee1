/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The feature points of somebody that the head of a channel takes (protocol/head-model.md). What a head makes
 * of them, the client says: here is checked what they must be whatever the head is. */
#ifndef FACCIA_NET_CALIBRATION_H
#define FACCIA_NET_CALIBRATION_H

#include "server/base/error.h"
#include <jansson.h>

enum {
    CALIBRATION_FARTHEST = 1000,          /* mm from the head's origin, along each axis */
    CALIBRATION_TEXTURE_BYTES = 196608,   /* of a picture in base64 */
    CALIBRATION_TEXTURE_POINTS = 1 << 22, /* that it may have: 2048 x 2048 */
    CALIBRATION_TEXTURE_SIDE = 8192       /* each way */
};

/* Copies featurePointsCoord, textureCoord and texture of a message into another object. -1 with *e and the
 * field. */
int calibration_take(const json_t *message, json_t *into, struct error *e);

#endif
