/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One utterance of a stream: a speech or a recording that is heard or waits, and the scenes of it that are
 * ready. It says its events and cuts its media; the stream decides when. */
#ifndef FACCIA_STREAM_TURN_H
#define FACCIA_STREAM_TURN_H

#include "server/base/utf8.h"
#include "server/stream/cut.h"
#include "server/stream/reel.h"
#include "server/stream/stream.h"

struct turn {
    struct turn *next;
    struct stream *stream;
    struct speech *speech; /* one of the two */
    struct reel *reel;
    uint32_t utterance;
    struct scene *scenes; /* the first is being cut */
    size_t scene_count, scene_cap;
    struct cut cut;
    uint64_t asked; /* uv_hrtime of the request */
    bool started, begun, sentence_said;
    bool finished;              /* no further scene comes */
    size_t spoken;              /* scenes that came */
    uint32_t sent, sample_rate; /* samples that left */
    bool placed;                /* life_begin is known */
    double life_begin, length;  /* its beginning on the life clock; of all scenes that came: s */
    struct mood *mood;          /* of an utterance whose seed gives it a clock of its own; else NULL */
    struct utf16_counter utf16;
};

void turn_start(struct turn *turn);
double turn_fps(const struct turn *turn);

/* Fills in what every event of the utterance says, and gives it to the sink. */
void turn_give(const struct turn *turn, const struct stream_sink *sink, void *ctx, struct stream_event event);

void turn_add_scene(struct turn *turn, struct scene scene);

/* The next chunk of the first scene; its frames have room for CUT_FRAMES. What begins in it is said first. */
void turn_cut(struct turn *turn, const struct stream_sink *sink, void *ctx, struct chunk *chunk,
              struct fap_frame *frames);

/* The sample that is heard at a moment when so many ms of what was sent are still to be heard. */
uint32_t turn_heard(const struct turn *turn, uint64_t unheard);

/* Of a speech that has been started. Forgets what is not sent, and goes on from that sentence, entered at its
 * mark of that name (NULL: at its beginning); the samples go on counting. */
void turn_seek(struct turn *turn, size_t sentence, const char *mark);

/* Has the sentences that are not begun made anew. */
void turn_respeak(struct turn *turn);

/* Of an utterance that is not begun: it may begin at another time than was thought. */
void turn_unplace(struct turn *turn);

/* Forgets the first scene when it has been cut to its end. */
void turn_drop_scene_if_done(struct turn *turn);

void turn_free(struct turn *turn);

#endif
