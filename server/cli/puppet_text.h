/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces as text, as iFacialMocap and Facemotion3d send them by UDP
 * (https://www.ifacialmocap.com/for-developer/):
 *   jawOpen-12|mouthSmile_L-5|...|=head#RX,RY,RZ,X,Y,Z|rightEye#RX,RY,RZ|leftEye#RX,RY,RZ|
 * with weights of 0 to 100 and turns in degrees; version 2 has & for the first -, and may have negative
 * weights. */
#ifndef FACCIA_CLI_PUPPET_TEXT_H
#define FACCIA_CLI_PUPPET_TEXT_H

#include "server/cli/puppet_packet.h"

/* What asks a telephone for its face, in version 2; either app ignores what is for the other. It is sent to
 * these ports of the telephone. */
#define PUPPET_TEXT_ASK "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719|sendDataVersion=v2"
#define PUPPET_TEXT_ASK_OTHER "FACEMOTION3D_OtherStreaming"
enum { PUPPET_TEXT_PORT = 49983, PUPPET_TEXT_PORT_OTHER = 49993 };

/* Sets what a packet tells of the face; what it leaves out stays. Returns whether it tells anything. */
bool puppet_text(struct puppet_face *face, const char *text, size_t size);

#endif
