/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures of how well a face can be lip-read: pure functions over a sentence and the face that goes with
 * it. */
#ifndef FACCIA_EVAL_EVAL_H
#define FACCIA_EVAL_EVAL_H

#include "protocol/fap.h"
#include "server/eval/lip_reader.h"
#include "server/face/engines/phone_segments.h"

/* Where continuity is asked for, the face is looked at this often, s. */
#define EVAL_FINE_STEP 0.001

/* A vowel counts as rounded when its corners' target before a pause is narrower than rest by this, mm. */
#define EVAL_ROUNDED_MM 2.0

/* A face over time; t = s from the sentence's first sample. */
struct eval_face {
    void (*sample)(void *self, double t, struct fap_frame *frame);
    void *self;
};

struct eval_input {
    const struct speech_pack *pack;
    const struct sentence_audio *audio;
    const char *text; /* whose bytes the sentence's words name */
    struct eval_face face;
    double fps;   /* at which viewers see it */
    double start; /* of the sentence in the speech, s: frame k is shown at k / fps of the speech */
};

/* Of bilabials and labiodentals, in the phones' own times. */
struct eval_touch {
    size_t count;
    size_t seen; /* in touch in at least one frame that is on the screen while the phone sounds */
    size_t held; /* in touch throughout the phone's middle third */
};

/* Of something that has targets, mm. Sums over count. */
struct eval_reach {
    size_t count;
    double reached, target;
    double error; /* of |reached - target| */
};

/* What has been measured so far; begins zeroed. */
struct eval {
    double seconds; /* of speech */
    size_t words, phones;
    struct eval_touch lips, teeth;
    struct eval_reach
        opening; /* of the inner lips in a vowel's middle third, against its own target in context */
    struct eval_reach rounding;     /* narrowing of the mouth in the middle third of rounded vowels */
    struct eval_reach protrusion;   /* mean of both lips, there */
    struct eval_reach anticipation; /* narrowing in the middle of a consonant before a rounded vowel, against
                                       that vowel's target */
    double speed;                   /* greatest, of the inner lips' gap from frame to frame, mm/s */
    double jerk;                    /* its greatest third difference, mm/s^3 */
    double overlap; /* the most by which the lips pass through each other beyond FAPMAP_MAX_PRESS, mm */
    struct lip_reader reader;
};

/* Measures one sentence more. */
void eval_add(struct eval *e, const struct eval_input *in);
void eval_free(struct eval *e);

enum { EVAL_MEASURES = 14 };

/* A figure that comes out. */
struct eval_measure {
    const char *name;  /* in JSON */
    const char *head;  /* of a column */
    const char *title; /* in a picture */
    enum {
        EVAL_SHARE,
        EVAL_RATIO,
        EVAL_MM,
        EVAL_SPEED,
        EVAL_JERK
    } unit; /* 0..1; 1 = on target; mm; mm/s; mm/s^3 */
};
extern const struct eval_measure eval_measures[EVAL_MEASURES];

/* All figures, in that order; NAN where the speech had nothing of the kind. Runs the reader, so call it once.
 */
void eval_values(struct eval *e, double values[EVAL_MEASURES]);

/* Positive = open, 0 = touching, negative = pressed: the inner lips' gap in the middle, mm of the modelled
 * speaker. */
double eval_gap(const struct speech_pack *pack, const struct fap_frame *frame);

/* The parts of eval_add. */
void eval_touch(struct eval *e, const struct eval_input *in, const struct phone_segments *g);
void eval_reach(struct eval *e, const struct eval_input *in, const struct phone_segments *g);
void eval_motion(struct eval *e, const struct eval_input *in, const struct phone_segments *g);

#endif
