/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One utterance of a stream: a speech that speaks or waits, and the scenes of it that are ready. It says its
 * events and cuts its media; the stream decides when. */
#ifndef FACCIA_STREAM_TURN_H
#define FACCIA_STREAM_TURN_H

#include "server/base/utf8.h"
#include "server/stream/cut.h"
#include "server/stream/stream.h"

struct turn {
    struct turn *next;
    struct stream *stream;
    struct speech *speech;
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

/* Fills in what every event of the utterance says, and gives it to the sink. */
void turn_give(const struct turn *turn, const struct stream_sink *sink, void *ctx, struct stream_event event);

void turn_add_scene(struct turn *turn, struct scene scene);

/* The next chunk of the first scene; its frames have room for CUT_FRAMES. What begins in it is said first. */
void turn_cut(struct turn *turn, const struct stream_sink *sink, void *ctx, struct chunk *chunk,
              struct fap_frame *frames);

/* Forgets the first scene when it has been cut to its end. */
void turn_drop_scene_if_done(struct turn *turn);

void turn_free(struct turn *turn);

#endif
