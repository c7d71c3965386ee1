/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence on its way, and its parts: each is spoken, silent or a sound. */
#ifndef FACCIA_VOICE_SENTENCE_PART_H
#define FACCIA_VOICE_SENTENCE_PART_H

#include "server/voice/sentence.h"
#include "server/voice/voice_selection.h"

struct sound_task;

/* A part of the sentence on its way. */
struct sentence_part {
    struct sentence *sentence;
    struct voice_part what;
    bool wanted, started, failed; /* failed: a sound that cannot be played */
    struct voice_job *job;
    struct sound_task *task;
    struct sentence_audio *u;
    struct error e;
};

struct sentence {
    struct voice_pool *pool;
    uv_loop_t *loop;
    struct voice_request request;
    const struct voice_selection *selection;
    struct voice_callbacks callbacks;
    void *ctx;
    struct plan cues; /* of the whole sentence */
    struct sentence_part *parts;
    size_t count, running, sounds;
    double seconds;   /* spoken or silent so far */
    uv_timer_t *soon; /* runs while the end is told in the loop's next turn; else NULL */
};

static inline const struct score_item *sentence_item(const struct sentence *s, size_t index) {
    return &s->request.score->items[index];
}

/* sentence_gather.c */
struct sentence_audio *sentence_silence(struct sentence *s, const struct voice_part *part);
struct sentence_audio *sentence_gather(struct sentence *s); /* all parts' sound, joined; takes theirs */

#endif
