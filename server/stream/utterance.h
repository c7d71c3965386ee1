/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One utterance of a stream: a speech, a recording or somebody's own voice that is heard or waits, and the
 * segments of it that are ready. It says its events and cuts its media; the stream decides when. */
#ifndef FACCIA_STREAM_UTTERANCE_H
#define FACCIA_STREAM_UTTERANCE_H

#include "server/base/utf8.h"
#include "server/stream/media.h"
#include "server/stream/stream.h"
#include "server/synthesis/live_voice.h"
#include "server/synthesis/media_segment.h"
#include "server/synthesis/recording.h"
#include "server/synthesis/synthesis.h"

/* Cutting a segment into pieces, and finding the words, marks and place that begin in each. */

/* Where one has come in a segment. Begins zeroed. */
struct segment_cut {
    uint32_t at; /* sample of the segment */
    size_t word, mark, phone;
};

/* The media from cut->at on, at most samples long, with frames of that placement in media->frames (room for
 * CUT_FRAMES). Moves cut->at on. The words and marks from cut->word and cut->mark on that begin before the
 * new cut->at belong to it. */
enum { CUT_FRAMES = 32 };
void segment_cut_media(struct segment_cut *cut, const struct media_segment *segment,
                       struct face_placement *face, double fps, uint32_t samples, struct media *media);

/* Enters the segment where it is to be heard from. */
void segment_cut_enter(struct segment_cut *cut, const struct media_segment *segment);

struct utterance {
    struct utterance *next;
    struct stream *stream;
    struct synthesis *synthesis; /* one of the three */
    struct recording *recording;
    struct live_voice *live;
    uint32_t number;
    enum speech_priority priority;
    struct media_segment *segments; /* the first is being cut */
    size_t segment_count, segment_cap;
    struct segment_cut cut;
    uint64_t asked; /* uv_hrtime of the request */
    bool started, begun, sentence_said;
    uint64_t abroad;             /* as its request (speech_request.h) */
    uint64_t order;              /* the same */
    bool spared;                 /* who asked has it spoken again when this daemon cannot */
    bool finished;               /* no further segment comes */
    size_t spoken;               /* segments that came */
    uint32_t sent, sample_rate;  /* samples that left */
    struct face_placement *face; /* of the first segment; NULL: not placed (again) yet */
    double life_begin;           /* its beginning on the life clock, s; once it has begun */
    struct fap_frame last;       /* that was given out */
    struct mood *mood;           /* of an utterance whose seed gives it a clock of its own; else NULL */
    struct utf16_counter utf16;
};

void utterance_start(struct utterance *utterance);

/* What was asked for, or NULL: a recording. */
const struct speech_request *utterance_request(const struct utterance *utterance);

double utterance_fps(const struct utterance *utterance);

/* Fills in what every event of the utterance says, and gives it to the sink. */
void utterance_give(const struct utterance *utterance, const struct stream_sink *sink, void *ctx,
                    struct stream_event event);

void utterance_add_segment(struct utterance *utterance, struct media_segment segment);

/* Whether nothing is left to be heard of what is still being written or said; and silence for a while. For so
 * many ms more what has been sent may last before that is wanted; below 0: it was all heard that long ago.
 */
bool utterance_awaits_text(const struct utterance *utterance);
int64_t utterance_patience(const struct utterance *utterance);
void utterance_wait(struct utterance *utterance);

/* The client's own name for it, or NULL. */
const char *utterance_id(const struct utterance *utterance);

/* Whether its face belongs to no clock but its own: it is the same whenever it is played. */
bool utterance_is_apart(const struct utterance *utterance);

/* Whether its face does not follow from the idle one, nor that from its: it is apart, or has more or less
 * life. */
bool utterance_is_foreign(const struct utterance *utterance);

/* The next media of the first segment; media->frames have room for CUT_FRAMES. What begins in it is said
 * first.
 */
void utterance_cut(struct utterance *utterance, const struct stream_sink *sink, void *ctx,
                   struct media *media);

/* The sample that is heard at a moment when so many ms of what was sent are still to be heard. */
uint32_t utterance_heard(const struct utterance *utterance, uint64_t unheard);

/* Of a speech that has been started. Forgets what is not sent, and goes on from that sentence, entered at its
 * mark of that name (NULL: at its beginning); the samples go on counting. */
void utterance_seek(struct utterance *utterance, size_t sentence, const char *mark);

/* Has the sentences that are not begun made anew. */
void utterance_respeak(struct utterance *utterance);

/* Its face is placed anew before it is seen again. */
void utterance_unplace(struct utterance *utterance);

/* Forgets the first segment when it has been cut to its end. */
void utterance_drop_segment_if_done(struct utterance *utterance);

void utterance_free(struct utterance *utterance);

#endif
