/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How somebody speaks, from his sound alone, while he does: when he begins and pauses, which syllables stand
 * out, how lively he is against how he has been. Nothing of what comes later is in it. Private to life. */
#ifndef FACCIA_FACE_LIFE_LIVE_H
#define FACCIA_FACE_LIFE_LIVE_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>
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

/* What the upper face and the head do with a voice that is heard while it speaks, from its sound alone: brows
 * and nods with syllables that stand out, a nod and a blink where a phrase ends, the eyes aside at the
 * beginning of a turn and at the listener at its end, brows and lids wider the livelier the voice is. It adds
 * to life, which goes on as while nobody speaks; jaw, lips and tongue it never touches. */

enum { LIFE_HEARD_RATE = 16000, LIFE_HEARD_STEP = 160 /* samples */ };

struct life_heard;

struct life_heard *life_heard_new(void);
void life_heard_free(struct life_heard *life);

/* Samples of one channel, -1..1, which wait until a step takes them. */
void life_heard_write(struct life_heard *life, const float *samples, size_t count);

/* Hears the next LIFE_HEARD_STEP of them; what is lacking is silence. */
void life_heard_step(struct life_heard *life);

/* The frame at t s, of the time that has been heard: adds to FAPs 19 to 26, 31 to 36 and 48 to 50. Times do
 * not go backwards. Where the eyes are life's to move, FAPs 23 to 26 are not in the frame's mask; what they
 * have keeps them where they look while the head moves. */
void life_heard_add(struct life_heard *life, double t, struct fap_frame *frame);

#endif
