/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads faces that other programs send by UDP: by the Virtual Motion Capture protocol (protocol.vmc.info), as
 * Live Link Face does to Unreal Engine, or as iFacialMocap does. */
#ifndef FACCIA_CLI_PUPPET_PACKET_H
#define FACCIA_CLI_PUPPET_PACKET_H

#include "server/codec/arkit_weights.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Turns of a bone, as a quaternion. */
struct puppet_bone {
    double x, y, z, w;
    bool known;
};

/* A face, and the state between packets. Zeroed: nothing has come. */
struct puppet_face {
    double weights[ARKIT_SHAPES]; /* finite, not limited */
    struct arkit_turns head;      /* its eyes are not used: gaze has shapes */
    bool turned;                  /* the head's turns are known */
    double time;                  /* s of the sender's clock; negative: it has told none */
    struct puppet_bone neck, skull;
    bool pending; /* a weight has come since the face before */
};

typedef void puppet_take(void *ctx, const struct puppet_face *face);

/* Reads a message or a bundle of OSC 1.0, or a packet of Live Link Face or iFacialMocap, and calls `take` for
 * each complete face. Ignores what is malformed or not about a face. */
void puppet_packet(struct puppet_face *face, const uint8_t *data, size_t size, puppet_take *take, void *ctx);

#endif
