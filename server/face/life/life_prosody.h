/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prosody of a sentence for head, eyes and brows: phrases, accents, and the final pitch. Private to life.
 * Times in s from the sentence's start. */
#ifndef FACCIA_FACE_LIFE_LIFE_PROSODY_H
#define FACCIA_FACE_LIFE_LIFE_PROSODY_H

#include "server/voice/sentence_audio.h"
#include <stdint.h>

/* Shorter gaps are closures or breaks within a phrase. */
#define PROSODY_PAUSE 0.07

struct accent {
    double at;     /* the vowel's middle */
    double weight; /* prominence, 0..1, from loudness, length and place relative to the others */
    bool major;    /* the strongest within PROSODY_MAJOR_GAP */
    double pitch;  /* of the stronger majors: semitones from their mean; 0 if unvoiced */
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
    int64_t name; /* seed for random numbers from the phones and approximate time: the same words spoken again
                     may differ by some samples and must get the same numbers. */
    double end;   /* of the sentence */
    double rise;  /* rise in semitones within the last voiced phone; 0 if unknown */
};

/* begin: the sentence's start on the layer's clock. Takes a few microseconds per second of speech, because
 * only samples at accents are examined. */
void prosody_of(const struct sentence_audio *u, double begin, struct prosody *out);
void prosody_free(struct prosody *prosody);

/* Fundamental frequency around that sample, Hz; 0 if unvoiced. */
double prosody_pitch(const struct sentence_audio *u, uint32_t sample);

#endif
