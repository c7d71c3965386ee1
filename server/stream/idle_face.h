/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the face of a stream is cut (a barge-in, a jump, a pause), what comes next begins elsewhere. Head,
 * eyes and brows go over to it from where they are. The mouth of speech does not: it has to be right at once.
 */
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
#define EASE_MOUTH 0.12 /* s, when nobody speaks */

enum {
    EASE_SOON_MS = 2000, /* what comes later than so long after a cut begins where it begins */
};

/* Begins zeroed. */
struct face_ease {
    bool shown;            /* there is a last frame */
    struct fap_frame last; /* that was given out */
    bool active;
    struct fap_frame from;
    double age;       /* s since the cut, of the media's time */
    uint64_t until;   /* loop time up to which the cut counts, ms; 0: there was none */
    bool from_is_set; /* else it is from the last frame */
};

/* The frames from now on do not follow from those before; from = NULL: from the last one. */
void face_ease_cut(struct face_ease *ease, const struct fap_frame *from, uint64_t now);

enum ease_what {
    EASE_NOTHING, /* what must be as it is: recordings, utterances that are to be repeated exactly */
    EASE_FACE,    /* all but the mouth */
    EASE_ALL,
};

/* Eases frames that are given out, and remembers the last. */
void face_ease_frames(struct face_ease *ease, enum ease_what what, uint64_t now, double fps,
                      struct fap_frame *frames, size_t count);

/* Changes frames so that they go over to `to`: they are the part from..end (0..1) of the way, at whose end
 * they are there. */
void face_ease_towards(const struct fap_frame *to, struct fap_frame *frames, double from, double end,
                       size_t count);

/* The mood of a stream: the mixture of affects that was asked for last, on the stream's life clock, and on
 * the clocks of utterances that have their own. */

/* What is asked for, as mood_set takes it. Strings are borrowed. */
struct mood_request {
    const char *names[MOOD_MIX];
    double intensities[MOOD_MIX]; /* 0..1 */
    size_t count;
    double ease; /* s */
};

struct mood_mix {
    const struct expressions *expressions; /* NULL: there are none */
    struct mood *mood;                     /* on the stream's clock; NULL: there are no expressions */
    struct mood_request asked;             /* its names belong to the mix */
    double last;                           /* when, s of the stream's clock */
};

void mood_mix_open(struct mood_mix *mix, const struct expressions *expressions);
void mood_mix_close(struct mood_mix *mix);

/* From time `at` on. -1 with *e as mood_set; then nothing has changed. */
int mood_mix_set(struct mood_mix *mix, const struct mood_request *asked, double at, struct error *e);

/* The mood as asked last, on a clock that begins with it. The caller frees it. NULL: there are no
 * expressions. */
struct mood *mood_mix_copy(const struct mood_mix *mix);

/* Has a copy change as the mix was, at `at` of the copy's clock. */
void mood_mix_follow(const struct mood_mix *mix, struct mood *copy, double at);

/* The face while nobody speaks, as media of silence (utterance 0) on a clock of their own. */

enum {
    IDLE_SAMPLE_RATE = 8000,
    IDLE_CHUNK_MS = 120,
    IDLE_LEAD_MS = 200, /* how far idle media may run ahead of real time */
    IDLE_FRAMES = 16,   /* most in one piece */
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
