/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face while nobody speaks, as media of silence (utterance 0) on a clock of their own. */
#ifndef FACCIA_STREAM_IDLE_FACE_H
#define FACCIA_STREAM_IDLE_FACE_H

#include "server/stream/media.h"
#include "server/synthesis/synthesis.h"

enum {
    IDLE_SAMPLE_RATE = 8000,
    IDLE_CHUNK_MS = 120,
    IDLE_LEAD_MS = 200, /* how far idle media may run ahead of real time */
    IDLE_FRAMES = 16,   /* most in one piece */
};

struct idle_options {
    double life;   /* strength, 0..2 */
    uint64_t seed; /* of the life layer */
    double fps;    /* 1..120 */
    bool still;    /* a face that does not move */
};

struct idle_face;

/* Begins at `now` (loop time, ms) on the idle clock's 0. The mood may be NULL; it has to outlive the idle. */
struct idle_face *idle_face_new(const struct idle_options *options, const struct mood *mood, uint64_t now);
void idle_face_free(struct idle_face *idle);

/* Whether it was made with these. */
bool idle_face_is(const struct idle_face *idle, const struct idle_options *options);

/* Seconds on the idle clock at that loop time. */
double idle_face_time(const struct idle_face *idle, uint64_t at);

/* IDLE_CHUNK_MS to be seen from the loop time `at` on, when the life layer's clock shows `life` seconds.
 * media->frames has room for IDLE_FRAMES. The clock begins anew at 0 when a chunk cannot count it. */
void idle_face_media(struct idle_face *idle, uint64_t at, double life, struct media *media);

#endif
