/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One sentence as spoken: samples with phones, words, marks and cues. The voice stage passes it to the
 * face stage. */
#ifndef FACCIA_VOICE_SENTENCE_AUDIO_H
#define FACCIA_VOICE_SENTENCE_AUDIO_H

#include "server/voice/voice_request.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PHONE_NAME_BYTES = 16 };

/* Phones are adjacent, in order, and cover the audio from 0 to its end. A pause has ipa "" and sampa "_". */
struct phone {
    char ipa[PHONE_NAME_BYTES];    /* UTF-8, without stress marks but with length marks */
    char sampa[PHONE_NAME_BYTES];  /* the same in X-SAMPA */
    char symbol[PHONE_NAME_BYTES]; /* the engine's own name */
    uint32_t start, end;           /* samples from the start of the audio */
    uint8_t stress;                /* 0 none, 1 secondary, 2 primary */
};

struct word {
    uint32_t start, end; /* samples */
    size_t from, to;     /* bytes of the input text */
    char *text;          /* the text given to the voice, UTF-8; NULL if unknown */
    float doubt;         /* 0 to 1: how doubtful the place is, for aligned recordings */
};

struct mark {
    char *name;
    uint32_t at; /* sample */
};

/* A cue of the score (struct score_cue) with its time in this sentence. A cue that covers several
 * sentences appears in each and does not fade in or out between them. */
struct cue {
    char *kind, *name;
    uint32_t start,
        end; /* samples, from the first word's start to the last word's end; start == end: a point */
    double intensity, weight; /* as in score_cue */
    double delay, duration;   /* s, from start; duration within this sentence */
    double onset, offset;     /* s; negative = the expression's default */
    bool began_before, goes_on;
};

struct sentence_audio {
    atomic_uint shared;   /* number of further owners */
    uint32_t sample_rate; /* Hz */
    int16_t *pcm;         /* mono; NULL = silence */
    uint32_t room;        /* samples of silence allocated before pcm (sentence_audio_lead_in) */
    uint32_t samples;
    struct phone *phones;
    size_t phone_count;
    struct word *words;
    size_t word_count;
    struct mark *marks;
    size_t mark_count;
    struct cue *cues;
    size_t cue_count;
    char **warnings; /* what the voice could not do */
    size_t warning_count;
    char lang[16];   /* BCP 47 of the voice that speaks most */
    bool mixed;      /* voices of other languages speak too */
    size_t from, to; /* the sentence's bytes in the input */
};

/* Adds an owner, from any thread. Each owner calls sentence_audio_free; shared audio must not be changed. */
struct sentence_audio *sentence_audio_share(struct sentence_audio *u);
void sentence_audio_free(struct sentence_audio *u);

/* Returns the sample of the named mark, or 0 if there is none or name is NULL. */
uint32_t sentence_audio_mark(const struct sentence_audio *u, const char *name);

/* Adds a copy of the warning unless it is already there. */
void sentence_audio_warn(struct sentence_audio *u, const char *message);

/* Converts the samples and all times except those of cues, which are set last. */
void sentence_audio_resample(struct sentence_audio *u, uint32_t sample_rate);

/* Keeps samples [from, to): phones and words are cut, marks outside move to the edge. Cut edges fade over
 * EDIT_FADE_MS, so that they do not click. Cues are not changed. */
enum { EDIT_FADE_MS = 10 };
void sentence_audio_cut(struct sentence_audio *u, uint32_t from, uint32_t to);

/* Inserts a pause before the sentence and moves everything with it, except marks and continued cues at its
 * very beginning. */
void sentence_audio_lead_in(struct sentence_audio *u, uint32_t samples);

/* Finds where the sound begins and ends: outside there is no sounding phone and nothing louder than 18 dB
 * below the peak (46 dB if no phones are known). from == to: silence. */
void sentence_audio_bounds(const struct sentence_audio *u, uint32_t *from, uint32_t *to);

struct join_piece {
    struct sentence_audio *u; /* consumed by the join */
    bool speech;              /* trim silence where it meets another piece */
    bool pauses;              /* a pause follows: keep part of the silence */
};

/* Silence kept on each side of a joint, in ms: within running speech, and where a pause follows. */
enum { JOIN_GAP_MS = 15, JOIN_PAUSE_MS = 180 };

/* Silence, in ms, that sentence_audio_lead_in can later add without copying the samples. */
enum { JOIN_ROOM_MS = 100 };

/* Joins the pieces (at least one) of several voices into one sentence's audio that sounds like one breath.
 * Its language is that of the longest speech; the caller sets cues and the place in the input. */
struct sentence_audio *sentence_audio_join(struct join_piece *pieces, size_t count, uint32_t sample_rate);

/* Adds the request's cues, timed by the words that they cover. The words must be final. Call once. */

void cue_times_set(struct sentence_audio *u, const struct voice_request *request);

/* Adds the score's cues that have a time instead of a place, as far as they fall within this audio, which
 * begins at `start` seconds of the text's clock. */
void cues_add_timed(struct sentence_audio *u, const struct score *score, double start);

#endif
