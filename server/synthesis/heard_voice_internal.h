/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a heard voice share. */
#ifndef FACCIA_SYNTHESIS_HEARD_VOICE_INTERNAL_H
#define FACCIA_SYNTHESIS_HEARD_VOICE_INTERNAL_H

#include "server/hear/hearing.h"
#include "server/synthesis/heard_pace.h"
#include "server/synthesis/heard_sound.h"
#include "server/synthesis/heard_voice.h"

struct heard_voice {
    const struct pipeline *pipeline;
    struct synthesis_callbacks callbacks;
    void *ctx;
    struct speech_request request;
    const struct speech_pack *pack;
    unsigned rate, lookahead;
    struct heard_sound *sound;
    struct heard_pace pace;
    struct hearing *hearing;
    uv_timer_t *timer;               /* while it is open */
    uint64_t last;                   /* loop time at which enough had come last (HEARD_LEAST_PERCENT), ms */
    uint64_t fresh;                  /* samples since then */
    struct heard_voice *prev, *next; /* of the pool's */
    bool started, closed, heard_all, finished;
    bool stalled; /* silence has been put in since something came */
    bool told_skip, told_bad;
    int16_t *pcm; /* heard, and not handed on, of which given is the first */
    size_t pcm_count, pcm_cap;
    struct fap_frame *frames; /* the same, from number first_frame on */
    size_t frame_count, frame_cap;
    uint32_t first_frame;
    uint32_t given; /* samples that have been handed on */
    size_t handed, released;
};

/* heard_segments.c: hears what waits, as far as it is wanted, and hands on what is whole. */
void heard_deliver(struct heard_voice *heard);

/* Hears these samples. */
void heard_hear(struct heard_voice *heard, const int16_t *samples, size_t count);

/* What the hearing tells. */
void heard_frame(void *heard, uint32_t k, const struct fap_frame *frame);

#endif
