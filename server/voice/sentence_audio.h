/* SPDX-License-Identifier: GPL-3.0-or-later */
/* the sentence's audio: one sentence as a voice spoke it. The voice stage hands it to the face stage. */
#ifndef FACCIA_VOICE_SENTENCE_AUDIO_H
#define FACCIA_VOICE_SENTENCE_AUDIO_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PHONE_NAME_BYTES = 16 };

/* Phones touch, in order, and cover the audio from 0 to its end. A pause has ipa "" and sampa "_". */
struct phone {
    char ipa[PHONE_NAME_BYTES];    /* UTF-8, without stress marks; length mark kept */
    char sampa[PHONE_NAME_BYTES];  /* X-SAMPA of the same */
    char symbol[PHONE_NAME_BYTES]; /* the voice's own name for it */
    uint32_t start, end;           /* samples from the sentence's audio's first */
    uint8_t stress;                /* 0 none, 1 secondary, 2 primary */
};

struct word {
    uint32_t start, end; /* samples */
    size_t from, to;     /* bytes of the input text */
    char *text;          /* what the voice was given to say, UTF-8; NULL when it is not known */
    float doubt;         /* 0 to 1 whether it is said there; of recordings that were aligned */
};

struct mark {
    char *name;
    uint32_t at; /* sample */
};

/* A cue of the score (struct score_cue) with its time in this sentence. One that covers several sentences is
 * in each; then it is not to fade in or out between them. */
struct cue {
    char *kind, *name;
    uint32_t start, end;      /* samples: first word's start to last word's end; start == end: a point */
    double intensity, weight; /* as in score_cue */
    double delay, duration;   /* s, from start; duration of the part in this sentence */
    double onset, offset;     /* s; negative = the expression's own */
    bool began_before, goes_on;
};

struct sentence_audio {
    atomic_uint shared;   /* further owners */
    uint32_t sample_rate; /* Hz */
    int16_t *pcm;         /* mono; NULL: silence */
    uint32_t room;        /* samples of silence in the same memory before pcm (sentence_audio_lead_in) */
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
    char lang[16];   /* BCP 47 of the voice, of several voices the one that speaks most */
    bool mixed;      /* voices of other languages speak in it too */
    size_t from, to; /* the sentence's bytes of the input */
};

/* One more owner, in any thread. Each calls sentence_audio_free, and none changes it any more. */
struct sentence_audio *sentence_audio_share(struct sentence_audio *u);
void sentence_audio_free(struct sentence_audio *u);

/* Frees the samples alone. */
void sentence_audio_drop_pcm(struct sentence_audio *u);

/* Where the mark of that name lies, sample; 0 when there is none, or name is NULL. */
uint32_t sentence_audio_mark(const struct sentence_audio *u, const char *name);

/* Adds a copy of the warning, unless it is there already. */
void sentence_audio_warn(struct sentence_audio *u, const char *message);

#endif
