/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the head, the eyes and the brows need to know of a sentence: phrases, accents, how the voice ends.
 * Private to life*.c. Times in s from the sentence's start. */
#ifndef FACCIA_FACE_LIFE_LIFE_PROSODY_H
#define FACCIA_FACE_LIFE_LIFE_PROSODY_H

#include "server/voice/sentence_audio.h"
#include <stdint.h>

/* Shorter ones are closures or breaks within a phrase. */
#define PROSODY_PAUSE 0.07

struct accent {
    double at;     /* the vowel's middle */
    double weight; /* prominence, 0..1, from loudness, length and place, against the others */
    bool major;    /* stands out: the strongest within PROSODY_MAJOR_GAP */
    double pitch;  /* of the stronger majors: semitones above (or below) their mean; 0 when unvoiced */
};

#define PROSODY_MAJOR_GAP 0.75

/* Speech between two pauses. */
struct phrase {
    double from, to;
    size_t first, count; /* accents */
};

struct prosody {
    struct phrase *phrases;
    size_t phrase_count, phrase_cap;
    struct accent *accents;
    size_t accent_count, accent_cap;
    int64_t name; /* of what is said and about when: to throw dice with. The same words spoken again may have
                     other times by some samples; the dice shall not fall otherwise for that. */
    double end;   /* of the sentence */
    double rise;  /* semitones that the voice rises in the last voiced phone; 0 when it cannot be heard */
};

/* begin: the sentence's start on the layer's clock. Costs a few microseconds for each second of speech:
 * samples are looked at where accents are. */
void prosody_of(const struct sentence_audio *u, double begin, struct prosody *out);
void prosody_free(struct prosody *prosody);

/* Fundamental frequency about that sample, Hz; 0 when there is none. */
double prosody_pitch(const struct sentence_audio *u, uint32_t sample);

#endif
