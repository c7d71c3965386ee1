/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the stream. An utterance: its source (speech_source.h), with the segments it has finished.
 * It reports events and cuts media; the stream decides when. */
#ifndef FACCIA_STREAM_STREAM_INTERNAL_H
#define FACCIA_STREAM_STREAM_INTERNAL_H

#include "protocol/fap.h"
#include "server/base/utf8.h"
#include "server/expression/expressions.h"
#include "server/normalize/lexicon.h"
#include "server/stream/drive_track.h"
#include "server/stream/media.h"
#include "server/stream/stream.h"
#include "server/synthesis/media_segment.h"
#include "server/synthesis/speech_source.h"
#include "server/synthesis/synthesis.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The face between utterances: easing after cuts, the stream's mood, and idle motion. Where a stream is
 * cut (barge-in, jump, pause), head, eyes and brows move smoothly to what comes next. The mouth of speech
 * does not ease: it must be right at once. */

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

/* Tells whether a FAP moves jaw, lips or tongue. */
bool face_ease_is_mouth(int n);

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

/* Makes ms of media to show from loop time `at` on, when the life clock is at `life` seconds.
 * media->frames has room for IDLE_FRAMES. The clock restarts at 0 before it overflows. */
void idle_face_media(struct idle_face *idle, uint64_t at, unsigned ms, double life, struct media *media);

/* Position within a segment. Zero-initialised. */
struct segment_cut {
    uint32_t at; /* sample of the segment */
    size_t word, mark, phone;
};

/* Cuts the media from cut->at on, at most `samples` long, with the placement's frames in media->frames
 * (room for CUT_FRAMES), and advances cut->at. Words and marks from cut->word and cut->mark on that begin
 * before the new cut->at belong to the chunk. */
enum { CUT_FRAMES = 32 };

struct utterance {
    struct utterance *next;
    struct stream *stream;
    struct speech_source *source;
    uint32_t number;
    enum speech_priority priority;
    struct media_segment *segments; /* the first is being cut */
    size_t segment_count, segment_cap;
    struct segment_cut cut;
    uint64_t asked; /* uv_hrtime of the request */
    bool started, begun, sentence_said;
    uint64_t origin;             /* of its request (speech_request.h) */
    uint64_t command;            /* likewise */
    bool spared;                 /* another daemon repeats it if this one cannot finish it */
    bool finished;               /* no further segment comes */
    size_t spoken;               /* segments received */
    uint32_t sent, sample_rate;  /* samples sent */
    struct face_placement *face; /* of the first segment; NULL = to be placed */
    double life_begin;           /* life clock at its beginning, s */
    struct fap_frame last;       /* last frame sent */
    struct mood *mood;           /* of an utterance with its own clock, else NULL */
    struct utf16_counter utf16;
};

void utterance_start(struct utterance *utterance);

double utterance_fps(const struct utterance *utterance);

/* Completes an event with the utterance's fields and sends it. */
void utterance_give(const struct utterance *utterance, const struct stream_sink *sink, void *ctx,
                    struct stream_event event);

void utterance_add_segment(struct utterance *utterance, struct media_segment segment);

/* utterance_awaits: nothing is left to play of an open or live utterance. utterance_patience: ms that sent
 * media may last before silence must be inserted; negative = overdue. */
bool utterance_awaits(const struct utterance *utterance);
int64_t utterance_patience(const struct utterance *utterance);

/* The client's id, or NULL. */
const char *utterance_id(const struct utterance *utterance);

/* Tells whether the face uses only its own clock, so that it is the same each time. */
bool utterance_is_apart(const struct utterance *utterance);

/* Tells whether the face does not continue the idle one: it has its own clock, or another strength of
 * life. */
bool utterance_is_foreign(const struct utterance *utterance);

/* Cuts the next media of the first segment, at most ms, after reporting what begins in it; media->frames has
 * room for CUT_FRAMES. */
void utterance_cut(struct utterance *utterance, unsigned ms, const struct stream_sink *sink, void *ctx,
                   struct media *media);

/* Returns the sample being heard while `unheard` ms of sent media are still to be heard. */
uint32_t utterance_heard(const struct utterance *utterance, uint64_t unheard);

/* Continues a started synthesis at a sentence, entered at its mark of that name (NULL: at its beginning),
 * dropping what was not sent; the sample count continues. */
void utterance_seek(struct utterance *utterance, size_t sentence, const char *mark);

/* Remakes the sentences not yet started. */
void utterance_respeak(struct utterance *utterance);

/* Places the face anew before it is next shown. */
void utterance_unplace(struct utterance *utterance);

/* Drops the first segment once it is cut completely. */
void utterance_drop_segment_if_done(struct utterance *utterance);

void utterance_free(struct utterance *utterance);

/* Private to the stream. */

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
    struct drive_track *drive; /* NULL = nobody drives the face */
    uint64_t driver;           /* who does */
    uint32_t driver_voice;     /* the live voice of the driver; 0 = none */
    struct lexicons lexicons;  /* none, or one */
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

/* Callbacks of an utterance's source; ctx is the utterance. */
extern const struct synthesis_callbacks utterance_callbacks;

/* playout.c */

/* Drops what was sent of utterances but not heard. */
void stream_forget_unheard(struct stream *stream);

/* Ends the first utterance. */
void stream_end_utterance(struct stream *stream, const char *reason);

#endif
