/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face of a performer who drives a stream in real time: frames arrive with the times of the performer's
 * clock, late by the jitter of the network, and are shown after the shortest delay that hides it. */
#ifndef FACCIA_STREAM_DRIVE_TRACK_H
#define FACCIA_STREAM_DRIVE_TRACK_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    DRIVE_FRAMES = 256, /* kept at most: more than two seconds at 120 a second */
};

#define DRIVE_LAG_MIN 0.02   /* s: bounds of the delay */
#define DRIVE_LAG_MAX 0.2    /* s */
#define DRIVE_HOLD 0.3       /* s for which the last frame stays when none follows */
#define DRIVE_EASE_IN 0.25   /* s from the idle face to the performer's */
#define DRIVE_EASE_OUT 0.5   /* s from the performer's to the idle face */
#define DRIVE_SILENCE_MAX 3. /* s without a frame after which the face is free for others */

struct driven_frame {
    double time;           /* s of the performer's clock */
    struct fap_frame faps; /* those in its mask are driven; only low-level ones, 3 to FAP_COUNT */
};

struct drive_track;

struct drive_track *drive_track_new(void);
void drive_track_free(struct drive_track *track);

/* Adds a frame that has arrived at `now` (s of this program's clock, as all times below). A frame that is not
 * after the one before is ignored, except when the performer's clock has begun anew. */
void drive_track_add(struct drive_track *track, const struct driven_frame *frame, double now);

/* Returns the delay in s with which frames are shown: their interval and their recent jitter, within
 * DRIVE_LAG_MIN and DRIVE_LAG_MAX. */
double drive_track_lag(const struct drive_track *track);

/* Returns when the last frame came, or was not to be shown before. */
double drive_track_heard(const struct drive_track *track);

/* Lays the performer's face of `at`, less the lag, over a frame: the FAPs that the performer names, without
 * those of the mouth unless `mouth`. When frames cease to come it eases out. Times must not decrease by more
 * than a chunk. */
void drive_track_show(struct drive_track *track, double at, bool mouth, struct fap_frame *frame);

#endif
