/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the stream itself share. */
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
    struct utterance *queue; /* the first speaks */
    unsigned waiting, queue_limit;
    uint32_t utterances;    /* numbers given so far */
    uint64_t played_until;  /* loop time at which all media sent will have been heard, ms */
    uint64_t spoken_until;  /* the same of the utterances' media: idle ones may be cut short */
    double life;            /* what the life clock shows at played_until, s; 0 before the first media */
    struct idle_face *idle; /* NULL: off */
    struct idle_options idling;
    struct mood_mix mix;
    struct face_ease ease;
    bool paused;
    uint64_t unheard; /* ms of the utterances' media that were sent before the pause and are heard after it */
};

/* playout.c: it owns the clock, and places what is said on it. */

/* Has the stream look after itself in so many ms. */
void stream_wake(struct stream *stream, uint64_t ms);

/* Media go on from the loop time `at`: what was sent for later is forgotten. */
void stream_go_on_from(struct stream *stream, uint64_t at);

/* The face of what comes does not follow from that of what was: it goes over to it. */
void stream_cut_face(struct stream *stream);

/* The utterance that speaks goes on from the loop time `at`, after a pause. */
void stream_resume_utterance(struct stream *stream, uint64_t at);

/* Where on the idle clock that loop time is; negative: nobody idles. */
double stream_idle_time(const struct stream *stream, uint64_t at);

/* stream.c */

/* What the synthesis of an utterance, its ctx, tells. */
extern const struct synthesis_callbacks utterance_callbacks;

/* stream_queue.c */

/* playout.c */

/* What was sent of utterances and has not been heard is forgotten. */
void stream_forget_unheard(struct stream *stream);

/* Ends the first utterance. */
void stream_end_utterance(struct stream *stream, const char *reason);

#endif
