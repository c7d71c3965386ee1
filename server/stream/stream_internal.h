/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the stream. An utterance: its source (speech_source.h), with the segments it has finished.
 * It reports events and cuts media; the stream decides when. */
#ifndef FACCIA_STREAM_STREAM_INTERNAL_H
#define FACCIA_STREAM_STREAM_INTERNAL_H

#include "server/base/utf8.h"
#include "server/normalize/lexicon.h"
#include "server/stream/idle_face.h"
#include "server/stream/media.h"
#include "server/stream/stream.h"
#include "server/synthesis/media_segment.h"
#include "server/synthesis/speech_source.h"
#include "server/synthesis/synthesis.h"

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

/* Cuts the next media of the first segment, after reporting what begins in it; media->frames has room for
 * CUT_FRAMES. */
void utterance_cut(struct utterance *utterance, const struct stream_sink *sink, void *ctx,
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
    struct lexicons lexicons; /* none, or one */
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
