/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to synthesis: the struct, sentences kept for seeking, open texts and speculation. */
#ifndef FACCIA_SYNTHESIS_SYNTHESIS_INTERNAL_H
#define FACCIA_SYNTHESIS_SYNTHESIS_INTERNAL_H

#include "server/base/utf8.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/track.h"
#include "server/markup/open_text.h"
#include "server/markup/speaker_runs.h"
#include "server/normalize/lexicon.h"
#include "server/normalize/normalizers.h"
#include "server/synthesis/synthesis.h"
#include "server/voice/sentence.h"

/* Limit of kept sentences per utterance, about 40 s of speech; the oldest are dropped. */
enum { KEPT_SPEECH_BYTES = 2 << 20 };

struct kept_sentence {
    size_t sentence;
    struct sentence_audio *audio;
    struct face_track *track;
};

/* Zero-initialised. */
struct kept_speech {
    struct kept_sentence *items; /* oldest first, no sentence twice */
    size_t count, cap, bytes;
};

/* Adds a reference to audio and track. */
void kept_speech_add(struct kept_speech *kept, const struct kept_sentence *sentence);

/* Returns NULL if it is not kept. Valid until the next call of kept_speech_add. */
const struct kept_sentence *kept_speech_find(const struct kept_speech *kept, size_t sentence);
void kept_speech_clear(struct kept_speech *kept);

/* Sentences in progress or waiting for release: enough to hide the voice's latency, few enough that a stop
 * wastes little and utterances share the voices fairly. */
enum { WINDOW = 3 };

struct slot {
    struct synthesis *synthesis;
    bool taken; /* by that sentence at that rate */
    size_t sentence;
    double rate;
    struct sentence *job;         /* set while the voice works on it */
    struct sentence_audio *audio; /* set when it is finished */
    struct face_track *track;     /* of a kept sentence */
    bool wait;                    /* silence while text is awaited */
    struct error failure;
};

/* Result of parsing a text. */
struct reading_result {
    struct score *document; /* the parsed text; NULL = see error */
    struct score *score;    /* the script to speak */
    struct voice_selection *chosen;
    enum face_blend blend; /* from the request and the text */
    struct error error;
    bool marks;                 /* it has marks */
    struct unspoken_told *told; /* of a piece: what earlier pieces reported; NULL: a whole text */
};

/* A text that is still being written. */
struct writing {
    struct open_text open;
    struct utf8_reader utf8;
    size_t text_cap;
    double paused;                        /* s: pauses in the parsed part */
    size_t *flushes;                      /* places where a piece was flushed */
    size_t flush_count, flush_cap, flush; /* index of the next one */
    bool closed;                          /* the text is complete */
    bool read;                            /* and completely parsed */
    struct error error;                   /* parsing stopped there; ERROR_NONE = no error */
    bool told;                            /* the error was reported */
    struct unspoken_told unspoken;
    uv_timer_t *timer;
    uv_timer_cb look;                /* runs when the timer fires */
    uint64_t first, last;            /* loop times of writes, ms */
    size_t writes;                   /* number of writes */
    uint64_t settle;                 /* ms of silence after a likely end that confirm it */
    struct speculation *speculation; /* the speculative sentence; NULL = none */
    size_t speculated, speculations; /* start of the last speculation, and attempts there */
};

/* While `reading`, the text and the result belong to the worker thread. */
struct synthesis {
    struct speech_source base;
    const struct pipeline *pipeline;
    const struct expressions *expressions; /* a reference to the version at the start */
    struct speech_request request;
    struct lexicons lexicons;     /* by precedence: its own, the work's, the room's, the daemon's */
    struct speaker_runs speakers; /* of the request; read with the text */
    struct speaker alone;         /* who speaks all of it, if there are none; borrows from the request */
    size_t lexicon_warned;        /* warnings of its own lexicon reported so far */
    const struct markup_kind *markup;
    const struct score *score; /* the script; NULL until the text is parsed */
    uv_work_t work;
    struct voice_list voices; /* for the worker thread */
    struct reading_result result;
    struct voice_wait *wait; /* waiting for voices to start */
    bool reading, started;
    atomic_bool given_up; /* read by the worker thread */
    const struct speech_pack *pack;
    const struct voice *voice;
    struct voice_selection *chosen;
    struct synthesis_callbacks callbacks;
    void *ctx;
    bool rung; /* the bell has been */
    bool keeps;
    struct kept_speech kept;
    struct slot slots[WINDOW];
    size_t submitted, delivered,
        released;  /* sentences; released <= delivered <= submitted <= released + WINDOW */
    size_t spoken; /* segments delivered */
    uint32_t samples, sample_rate;
    char *entry;             /* mark at which the next sentence is entered, or NULL */
    bool finished;           /* `finished` was called */
    size_t warned;           /* markup warnings reported so far */
    struct writing *writing; /* NULL = not an open text */
    bool busy, freed;        /* inside a callback; freed when it returns */
};

/* Completes a sentence's audio; makes its segment with its track from the slot, taking both, and counts
 * its samples. */
void synthesis_prepare(const struct synthesis *synthesis, struct sentence_audio *audio);
struct media_segment synthesis_segment(struct synthesis *synthesis, struct slot *slot);

/* Returns a silent segment to play while text is awaited; later segments follow it. */
/* Builds the bell, which sounds before the sentence of the slot. */
struct media_segment synthesis_bell(struct synthesis *synthesis, const struct slot *before);

struct media_segment synthesis_wait(struct synthesis *synthesis, unsigned ms);

/* Chooses the request's language and voice and checks that the engine supports them. Returns -1 with *e. */
int synthesis_choose(struct synthesis *synthesis, struct error *e);

/* Rules for parsing the text; making the script of a document, with its voices. Callable from any thread.
 * With a limit, most sentences are left for synthesis_normalize, so that the first one is heard soon. */
struct markup_rules synthesis_rules(const struct synthesis *synthesis);
void synthesis_direct(const struct synthesis *synthesis, struct reading_result *result,
                      struct work_limit *limit);

/* Normalises a sentence of the script (numbers and signs to words) unless that has been done. */
void synthesis_normalize(const struct synthesis *synthesis, struct score *script,
                         const struct voice_selection *chosen, size_t sentence);

/* Starts speaking the sentence that the last write may have completed. */
void speculation_check(struct synthesis *synthesis);

/* The slot's sentence is now known: gives it the speculative result if it matches, now or later through
 * deliver. Returns false if it does not match. */
bool speculation_take(struct synthesis *synthesis, struct slot *slot,
                      void (*deliver)(struct synthesis *synthesis));

/* Detaches the slot from the speculation. Returns false if it was not attached. */
bool speculation_cancel(struct synthesis *synthesis, const struct slot *heir);
void speculation_drop(struct synthesis *synthesis);

void writing_free(struct synthesis *synthesis);
void writing_wake(struct synthesis *synthesis, uint64_t ms); /* calls `look` after ms */

/* Call when the voice is known. */
void writing_begin(struct synthesis *synthesis);

/* Parses a piece and appends it to `into` (score, chosen, marks, blend). Returns -1 with *e. */
int writing_read_piece(struct synthesis *synthesis, const struct open_piece *piece,
                       struct reading_result *into, struct error *e);

/* Parses until one more sentence is complete. Returns false if more text is needed. */
bool writing_read(struct synthesis *synthesis);

#endif
