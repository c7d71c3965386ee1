/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face between utterances: easing after cuts, the stream's mood, and idle motion. Where a stream is
 * cut (barge-in, jump, pause), head, eyes and brows move smoothly to what comes next. The mouth of speech
 * does not ease: it must be right at once. */
#ifndef FACCIA_STREAM_IDLE_FACE_H
#define FACCIA_STREAM_IDLE_FACE_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/stream/stream.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct idle_options;
struct media;

#define EASE_UPPER 0.35 /* s */
#define EASE_MOUTH 0.12 /* s, outside speech */

enum {
    EASE_SOON_MS = 2000, /* frames later than this after a cut do not ease */
};

/* Zero-initialised. */
struct face_ease {
    bool shown;            /* `last` is valid */
    struct fap_frame last; /* last frame sent */
    bool active;
    struct fap_frame from;
    double age;       /* s of media time since the cut */
    uint64_t until;   /* loop time until which the cut counts, ms; 0 = no cut */
    bool from_is_set; /* else ease from the last frame */
};

/* Eases the following frames from `from`; NULL = from the last frame. */
void face_ease_cut(struct face_ease *ease, const struct fap_frame *from, uint64_t now);

enum ease_what {
    EASE_NOTHING, /* must not change: recordings, reproducible utterances */
    EASE_FACE,    /* everything but the mouth */
    EASE_ALL,
};

/* Eases outgoing frames and remembers the last one. */
void face_ease_frames(struct face_ease *ease, enum ease_what what, uint64_t now, double fps,
                      struct fap_frame *frames, size_t count);

/* Blends frames into `to`: they cover the part from..end (0..1) of the transition. */
void face_ease_towards(const struct fap_frame *to, struct fap_frame *frames, double from, double end,
                       size_t count);

/* The stream's mood: the last requested mixture of affects, on the stream's life clock and on the clocks
 * of utterances that have their own. */

struct mood_mix {
    const struct expressions *expressions; /* NULL = no expressions */
    struct mood *mood;                     /* on the stream's clock; NULL = no expressions */
    struct mood_request asked;             /* with names owned by the mix */
    double last;                           /* time of the request, s of the stream's clock */
};

void mood_mix_open(struct mood_mix *mix, const struct expressions *expressions);
void mood_mix_close(struct mood_mix *mix);

/* Sets the mixture from time `at` on. Returns -1 with *e like mood_set, without any change. */
int mood_mix_set(struct mood_mix *mix, const struct mood_request *asked, double at, struct error *e);

/* Copies the mood with a clock that starts now. The caller frees it. Returns NULL without expressions. */
struct mood *mood_mix_copy(const struct mood_mix *mix);

/* Repeats the last change in a copy, at `at` of the copy's clock. */
void mood_mix_follow(const struct mood_mix *mix, struct mood *copy, double at);

/* Idle motion, as silent media (utterance 0) on its own clock. */

enum {
    IDLE_SAMPLE_RATE = 8000,
    IDLE_CHUNK_MS = 120,
    IDLE_LEAD_MS = 200, /* how far idle media run ahead of real time */
    IDLE_FRAMES = 16,   /* maximum per chunk */
};

struct idle_face;

/* Starts at `now` (loop time, ms). mood may be NULL and must outlive it. */
struct idle_face *idle_face_new(const struct idle_options *options, const struct mood *mood, uint64_t now);
void idle_face_free(struct idle_face *idle);

/* Tells whether it was created with these options. */
bool idle_face_is(const struct idle_face *idle, const struct idle_options *options);

/* Converts loop time to seconds of the idle clock. */
double idle_face_time(const struct idle_face *idle, uint64_t at);

/* Makes IDLE_CHUNK_MS of media to show from loop time `at` on, when the life clock is at `life` seconds.
 * media->frames has room for IDLE_FRAMES. The clock restarts at 0 before it overflows. */
void idle_face_media(struct idle_face *idle, uint64_t at, double life, struct media *media);

#endif
