/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ARKit's weights as packets of Open Sound Control (OSC 1.0, opensoundcontrol.org), in the words of the
 * Virtual Motion Capture protocol (protocol.vmc.info): what puppets of VRM listen to. */
#ifndef FACCIA_CODEC_OSC_H
#define FACCIA_CODEC_OSC_H

#include "server/base/buf.h"
#include "server/codec/arkit_table.h"

/* A packet is a bundle that fits into one datagram of any network; a frame takes so many. */
enum { OSC_PACKET_MOST = 1400, OSC_PACKETS_MOST = 8 };

struct osc_packets {
    struct buf bytes;
    size_t ends[OSC_PACKETS_MOST]; /* of each packet, in bytes */
    size_t count;
};

/* Replaces what is in packets by all weights of one frame: "/VMC/Ext/Blend/Val" NAME WEIGHT for each, and at
 * the end
 * "/VMC/Ext/Blend/Apply". */
void osc_frame(const double weights[ARKIT_SHAPES], struct osc_packets *packets);
void osc_packets_free(struct osc_packets *packets);

#endif
