/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plays a speech's face to a puppet: the frames leave as datagrams (codec/osc.h) when their time has come. */
#ifndef FACCIA_APP_OSC_PLAY_H
#define FACCIA_APP_OSC_PLAY_H

#include "server/export/export.h"
#include <uv.h>

struct osc_play;

/* To "HOST:PORT", "[ADDRESS]:PORT". NULL after a message. */
struct osc_play *osc_play_open(uv_loop_t *loop, const char *target, const struct export_source *source);

/* A segment's frames; the first frame of the first one is shown at once. */
void osc_play_add(struct osc_play *play, const struct media_segment *segment);
void osc_play_end(struct osc_play *play); /* no more will come */

/* Whether something is left to be shown. */
bool osc_play_busy(const struct osc_play *play);
void osc_play_free(struct osc_play *play); /* the loop must run on until it is empty */

#endif
