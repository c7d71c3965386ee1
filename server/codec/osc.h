/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ARKit weights as Open Sound Control packets (OSC 1.0, opensoundcontrol.org) of the Virtual Motion
 * Capture protocol (protocol.vmc.info), for VRM avatars. */
#ifndef FACCIA_CODEC_OSC_H
#define FACCIA_CODEC_OSC_H

#include "server/base/buf.h"
#include "server/codec/arkit_table.h"

/* A packet is a bundle that fits one datagram in any network; a frame takes up to OSC_PACKETS_MOST. */
enum { OSC_PACKET_MOST = 1400, OSC_PACKETS_MOST = 8 };

struct osc_packets {
    struct buf bytes;
    size_t ends[OSC_PACKETS_MOST]; /* of each packet, in bytes */
    size_t count;
};

/* Replaces the packets with all weights of one frame: "/VMC/Ext/Blend/Val" NAME WEIGHT for each, then
 * "/VMC/Ext/Blend/Apply". */
void osc_frame(const double weights[ARKIT_SHAPES], struct osc_packets *packets);
void osc_packets_free(struct osc_packets *packets);

#endif
