/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a speech share. */
#ifndef FACCIA_STREAM_SPEECH_PARTS_H
#define FACCIA_STREAM_SPEECH_PARTS_H

#include "server/markup/markup.h"
#include "server/stream/casting.h"
#include "server/stream/speech.h"
#include "server/voice/sentence.h"

/* Sentences that are being spoken or wait to be used up: enough to hide the voice's work, few enough that a
 * stop wastes little and that many speeches share the voices fairly. */
enum { WINDOW = 3 };

struct slot {
    struct speech *speech;
    struct sentence *job;        /* set while the voice works on it */
    struct utterance *utterance; /* set when it is ready */
    struct error failure;
};

/* What reading a text gives. */
struct reading_result {
    struct score *score; /* NULL: error says why */
    struct cast *cast;
    struct error error;
};

/* While `reading`, the text and what reading it gives belong to the other thread. */
struct speech {
    const struct studio *studio;
    struct speech_request request;
    const struct markup_kind *markup;
    struct score *score; /* NULL until the text has been read */
    uv_work_t work;
    struct voice_list voices; /* for the other thread */
    struct reading_result result;
    struct voice_wait *wait; /* the voices are still starting: the voice is not chosen yet */
    bool reading, started;
    atomic_bool given_up; /* read by the other thread */
    const struct speech_pack *pack;
    const struct voice *voice;
    struct cast *cast;
    struct speech_callbacks callbacks;
    void *ctx;
    void (*direct_face)(void *ctx, struct face_options *options);
    struct slot slots[WINDOW];
    size_t submitted, delivered,
        released;  /* sentences; released <= delivered <= submitted <= released + WINDOW */
    size_t spoken; /* scenes that came */
    uint32_t samples, sample_rate;
    char *entry;      /* the mark at which the next sentence is entered, or NULL */
    bool warned;      /* of what the markup stage did not act on */
    bool busy, freed; /* inside a callback; to be freed after it */
};

/* speech.c: the text has been read, or cannot be. */
void speech_go_on(struct speech *speech);

#endif
