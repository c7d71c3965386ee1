/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the stream. */
#ifndef FACCIA_STREAM_STREAM_INTERNAL_H
#define FACCIA_STREAM_STREAM_INTERNAL_H

#include "server/stream/idle_face.h"
#include "server/stream/stream.h"
#include "server/stream/utterance.h"

struct stream {
    const struct pipeline *pipeline;
    struct stream_sink sink;
    void *ctx;
    uv_timer_t *timer;
    struct utterance *queue; /* the first is playing */
    unsigned waiting, queue_limit;
    uint32_t utterances;    /* last number assigned */
    uint64_t played_until;  /* loop time when all sent media will have been heard, ms */
    uint64_t spoken_until;  /* the same for utterances only, because idle media may be cut */
    double life;            /* life clock at played_until, s; 0 before the first media */
    struct idle_face *idle; /* NULL = off */
    struct idle_options idling;
    struct mood_mix mix;
    struct face_ease ease;
    bool paused;
    uint64_t unheard; /* ms of media sent before the pause and heard after it */
};

/* playout.c: owns the clock. */

/* Schedules the next pump after ms. */
void stream_wake(struct stream *stream, uint64_t ms);

/* Continues at loop time `at` and drops media sent for later. */
void stream_go_on_from(struct stream *stream, uint64_t at);

/* Eases the face into what comes next. */
void stream_cut_face(struct stream *stream);

/* Continues the current utterance at loop time `at`, after a pause. */
void stream_resume_utterance(struct stream *stream, uint64_t at);

/* Converts loop time to the idle clock; negative = no idling. */
double stream_idle_time(const struct stream *stream, uint64_t at);

/* stream.c */

/* Callbacks of an utterance's synthesis; ctx is the utterance. */
extern const struct synthesis_callbacks utterance_callbacks;

/* playout.c */

/* Drops what was sent of utterances but not heard. */
void stream_forget_unheard(struct stream *stream);

/* Ends the first utterance. */
void stream_end_utterance(struct stream *stream, const char *reason);

#endif
