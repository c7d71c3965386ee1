/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a speech share. */
#ifndef FACCIA_SYNTHESIS_SYNTHESIS_INTERNAL_H
#define FACCIA_SYNTHESIS_SYNTHESIS_INTERNAL_H

#include "server/markup/markup.h"
#include "server/synthesis/kept_speech.h"
#include "server/synthesis/select_voices.h"
#include "server/synthesis/synthesis.h"
#include "server/voice/sentence.h"

/* Sentences that are being spoken or wait to be used up: enough to hide the voice's work, few enough that a
 * stop wastes little and that many speeches share the voices fairly. */
enum { WINDOW = 3 };

struct slot {
    struct synthesis *synthesis;
    bool taken; /* by that sentence, spoken at that rate */
    size_t sentence;
    double rate;
    struct sentence *job;         /* set while the voice works on it */
    struct sentence_audio *audio; /* set when it is ready */
    struct face_track *track;     /* of one that was kept */
    struct error failure;
};

/* What reading a text gives. */
struct reading_result {
    struct score *document; /* what the text says; NULL: error says why */
    struct score *score;    /* its script: what is spoken */
    struct voice_selection *chosen;
    enum face_blend blend; /* what the request and the text ask for */
    struct error error;
    bool marks; /* it has some */
};

/* While `reading`, the text and what reading it gives belong to the other thread. */
struct synthesis {
    const struct pipeline *pipeline;
    struct speech_request request;
    const struct markup_kind *markup;
    const struct score *score; /* the script; NULL until the text has been read */
    uv_work_t work;
    struct voice_list voices; /* for the other thread */
    struct reading_result result;
    struct voice_wait *wait; /* the voices are still starting: the voice is not chosen yet */
    bool reading, started;
    atomic_bool given_up; /* read by the other thread */
    const struct speech_pack *pack;
    const struct voice *voice;
    struct voice_selection *chosen;
    struct synthesis_callbacks callbacks;
    void *ctx;
    bool keeps;
    struct kept_speech kept;
    struct slot slots[WINDOW];
    size_t submitted, delivered,
        released;  /* sentences; released <= delivered <= submitted <= released + WINDOW */
    size_t spoken; /* segments that came */
    uint32_t samples, sample_rate;
    char *entry;      /* the mark at which the next sentence is entered, or NULL */
    bool finished;    /* that has been said */
    bool warned;      /* of what the markup stage did not act on */
    bool busy, freed; /* inside a callback; to be freed after it */
};

/* speech.c: the text has been read, or cannot be. */
void synthesis_go_on(struct synthesis *synthesis);

#endif
