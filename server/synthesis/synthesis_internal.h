/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that have been spoken and may be wanted again: their audio and their tracks, which do not change.
 * Private to synthesis. */
#ifndef FACCIA_SYNTHESIS_SYNTHESIS_INTERNAL_H
#define FACCIA_SYNTHESIS_SYNTHESIS_INTERNAL_H

#include "server/base/utf8.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/track.h"
#include "server/markup/open_text.h"
#include "server/synthesis/synthesis.h"
#include "server/voice/sentence.h"

/* More than this of one utterance is not kept: the oldest goes. About 40 s of speech. */
enum { KEPT_SPEECH_BYTES = 2 << 20 };

struct kept_sentence {
    size_t sentence;
    struct sentence_audio *audio;
    struct face_track *track;
};

/* Begins zeroed. */
struct kept_speech {
    struct kept_sentence *items; /* the oldest first; no sentence twice */
    size_t count, cap, bytes;
};

/* Shares both. */
void kept_speech_add(struct kept_speech *kept, const struct kept_sentence *sentence);

/* NULL: it is not there. Good until something is added. */
const struct kept_sentence *kept_speech_find(const struct kept_speech *kept, size_t sentence);
void kept_speech_clear(struct kept_speech *kept);

/* Chooses who speaks each item of a score, and finds the sounds that it asks for. */

/* What the files of a speech share. */

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
    bool wait;                    /* silence, while text is awaited */
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

/* A text that is still being written. */
struct writing {
    struct open_text open;
    struct utf8_reader utf8;
    size_t text_cap;
    double paused;                        /* s: the pauses of what was read */
    size_t *flushes;                      /* places of the text at which a piece ends */
    size_t flush_count, flush_cap, flush; /* the next of them */
    bool closed;                          /* nothing is written any more */
    bool read;                            /* and all of it has been read */
    struct error error;                   /* nothing behind that is read; code ERROR_NONE: none */
    bool told;                            /* of the error */
    uv_timer_t *timer;
    uv_timer_cb look;     /* after itself, when the timer says so */
    uint64_t first, last; /* loop times at which something was written, ms */
    size_t writes;        /* how often */
    uint64_t settle;      /* nothing for so long after what looks like an end means that it is one, ms */
    struct speculation
        *speculation; /* a sentence that seems to have ended is being spoken ahead; NULL: none */
    size_t speculated, speculations; /* where the last that was speculated begins; and how often that was */
};

/* While `reading`, the text and what reading it gives belong to the other thread. */
struct synthesis {
    const struct pipeline *pipeline;
    const struct expressions *expressions; /* a share of those that there were when it began */
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
    char *entry;             /* the mark at which the next sentence is entered, or NULL */
    bool finished;           /* that has been said */
    size_t warned;           /* so many of the markup stage's warnings */
    struct writing *writing; /* NULL: the text is there */
    bool busy, freed;        /* inside a callback; to be freed after it */
};

/* Asks for what may be spoken, and hands on, in order, what is ready. */
void synthesis_submit(struct synthesis *synthesis);
void synthesis_deliver(struct synthesis *synthesis);

/* synthesis_segment.c: what a sentence's audio still needs; and the segment of it, with its track, which
 * takes both from the slot: its samples are counted. */
void synthesis_prepare(const struct synthesis *synthesis, struct sentence_audio *audio);
struct media_segment synthesis_segment(struct synthesis *synthesis, struct slot *slot);

/* synthesis_choose.c */

/* The language and the voice that the request asks for, and whether the engine speaks it. -1 with *e. */
int synthesis_choose(struct synthesis *synthesis, struct error *e);

/* What a reader of this text has to know; the script of a document, with its voices. In any thread. */
struct markup_rules synthesis_rules(const struct synthesis *synthesis);
void synthesis_direct(const struct synthesis *synthesis, struct reading_result *result);

/* synthesis_guess.c */

/* What was written last may have ended a sentence that is awaited: the voice begins with it. */
void speculation_check(struct synthesis *synthesis);

/* The sentence of the slot is known: it gets what was speculated, if it was that, now or with deliver later.
 * False: it was not. */
bool speculation_take(struct synthesis *synthesis, struct slot *slot,
                      void (*deliver)(struct synthesis *synthesis));

/* The slot does not need what it was to get. False: it was to get nothing. */
bool speculation_cancel(struct synthesis *synthesis, const struct slot *heir);
void speculation_drop(struct synthesis *synthesis);

/* synthesis_writing.c */
void writing_open(struct synthesis *synthesis);

/* synthesis_reading.c */
void writing_free(struct synthesis *synthesis);
void writing_wake(struct synthesis *synthesis, uint64_t ms); /* it looks after itself in so many ms */

/* The voice is known. */
void writing_begin(struct synthesis *synthesis);

/* Reads a piece, behind what is in `into` (score, chosen, marks, blend). -1 with *e. */
int writing_read_piece(struct synthesis *synthesis, const struct open_piece *piece,
                       struct reading_result *into, struct error *e);

/* Reads on until there is one more sentence. False: nothing more is known yet. */
bool writing_read(struct synthesis *synthesis);

#endif
