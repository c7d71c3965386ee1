/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How somebody speaks, from his sound alone, while he does: when he begins and pauses, which syllables stand
 * out, how lively he is against how he has been. Nothing of what comes later is in it. Private to life. */
#ifndef FACCIA_FACE_LIFE_HEARD_PROSODY_H
#define FACCIA_FACE_LIFE_HEARD_PROSODY_H

#include "server/face/life/life_heard.h"
#include <stdbool.h>
#include <stdint.h>

enum {
    PROSODY_RATE = LIFE_HEARD_RATE,
    PROSODY_STEP = LIFE_HEARD_STEP,
    PROSODY_WINDOW = 640, /* what pitch is looked for in */
};

/* Means over the last so many, of those few that there are at the beginning. */
struct running_mean {
    double value, count;
};

struct heard_prosody {
    int16_t pcm[PROSODY_WINDOW];
    double power, loudest, floor; /* of the sound; dB */
    bool speaks;
    unsigned loud, quiet, phrase, silence; /* steps: in a row; since he began; before that */
    bool rises;                            /* towards a syllable's loudest moment */
    double peak, pitch, dip;               /* dB, Hz, dB */
    unsigned since_peak, since_syllable, since_accent;
    unsigned syllables;
    struct running_mean usual_loudness, loudness, usual_pitch, height, usual_gap, gap;
};

/* What a step has brought. */
struct heard_moment {
    bool begins, ends; /* he speaks; a phrase is over, PROSODY_PAUSE_STEPS ago */
    double seconds;    /* of silence before it; of the phrase */
    bool stands_out;   /* a syllable did, some 30 to 80 ms ago */
    double weight;     /* how much, 0..1 */
    double semitones;  /* how far its pitch lay above his usual one */
};

enum { PROSODY_PAUSE_STEPS = 25 };

void heard_prosody_begin(struct heard_prosody *prosody);

/* Takes the next PROSODY_STEP samples, -1..1. */
struct heard_moment heard_prosody_step(struct heard_prosody *prosody, const float *samples);

/* How much louder, higher and faster he is than usual, -1..1; 0 until enough has been heard. */
double heard_prosody_arousal(const struct heard_prosody *prosody);

#endif
