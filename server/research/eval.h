/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A nearest-neighbour lip reader: measures how well viseme classes can be told apart by the lips alone. It
 * learns from half of the words and reads the other half. A sample is a phone: the lip FAPs at its middle and
 * at the middles of both neighbours; its class is its viseme group. Features are scaled to unit variance over
 * the training half. */
#ifndef FACCIA_RESEARCH_EVAL_H
#define FACCIA_RESEARCH_EVAL_H

#include "protocol/fap.h"
#include "server/face/engines/phone_segments.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    READER_FAPS = 22, /* 4-13, 16, 17, 51-60 */
    READER_FEATURES = 3 * READER_FAPS,
    READER_MAX = 4000, /* samples in each half, a bound for time and memory; further ones are ignored */
};

extern const uint8_t reader_faps[READER_FAPS];

struct lip_reader_sample {
    const void *class; /* identity of its class */
    float features[READER_FEATURES];
};

enum { READER_LEARN, READER_READ, READER_HALVES };

/* Begins zeroed. */
struct lip_reader {
    struct lip_reader_sample *samples[READER_HALVES];
    size_t count[READER_HALVES], cap[READER_HALVES];
};

/* Returns the half of a word, ignoring ASCII case: equal words are in the same half. */
int lip_reader_half(const char *word, size_t size);

void lip_reader_add(struct lip_reader *r, int half, const struct lip_reader_sample *sample);

struct lip_reader_result {
    size_t read, right;
    size_t usual; /* correct answers if the most frequent class were always chosen */
};

/* Scales the samples in place, so call it once. */
struct lip_reader_result reader_run(struct lip_reader *r);
void lip_reader_free(struct lip_reader *r);

/* Measures of how well a face can be lip-read: pure functions of a sentence and its face. */

/* Sampling interval of continuous measures, s. */
#define EVAL_FINE_STEP 0.001

/* A vowel counts as rounded when the target of its corners before a pause is narrower than rest by this,
 * mm. */
#define EVAL_ROUNDED_MM 0.7

/* A face over time; t = s from the sentence's first sample. */
struct eval_face {
    void (*sample)(void *self, double t, struct fap_frame *frame);
    void *self;
};

struct eval_input {
    const struct speech_pack *pack;
    const struct sentence_audio *audio;
    const char *text; /* the text that the words' bytes refer to */
    struct eval_face face;
    double fps;   /* frame rate for the viewer */
    double start; /* start of the sentence, s: frame k is shown at k / fps of the speech */
};

/* Contacts of bilabials and labiodentals, in the phones' own times. */
struct eval_touch {
    size_t count;
    size_t seen; /* contact in at least one frame shown during the phone */
    size_t held; /* contact throughout the phone's middle third */
};

/* Distance from targets, mm; sums over count. */
struct eval_reach {
    size_t count;
    double reached, target;
    double error; /* of |reached - target| */
};

/* Sums so far; begins zeroed. */
struct eval {
    double seconds; /* of speech */
    size_t words, phones;
    struct eval_touch lips, teeth;
    struct eval_reach
        opening; /* of the inner lips in a vowel's middle third, relative to its own target in context */
    struct eval_reach rounding;     /* narrowing of the mouth in the middle third of rounded vowels */
    struct eval_reach protrusion;   /* mean of both lips, in the same place */
    struct eval_reach anticipation; /* narrowing in the middle of a consonant before a rounded vowel, relative
                                       to that vowel's target */
    double speed;                   /* maximum of the inner lips' gap between frames, mm/s */
    double jerk;                    /* maximum third difference of the gap, mm/s^3 */
    double overlap;                 /* maximum by which the lips overlap beyond FAPMAP_MAX_PRESS, mm */
    struct lip_reader reader;
};

/* Measures another sentence. */
void eval_add(struct eval *e, const struct eval_input *in);
void eval_free(struct eval *e);

enum { EVAL_MEASURES = 14 };

/* A result. */
struct eval_measure {
    const char *name;  /* in JSON */
    const char *head;  /* column heading */
    const char *title; /* in a chart */
    enum {
        EVAL_SHARE,
        EVAL_RATIO,
        EVAL_MM,
        EVAL_SPEED,
        EVAL_JERK
    } unit; /* 0..1; 1 = on target; mm; mm/s; mm/s^3 */
};
extern const struct eval_measure eval_measures[EVAL_MEASURES];

/* Computes all results in that order; NAN where the speech has no such sound. Runs the lip reader, so call
 * it once. */
void eval_values(struct eval *e, double values[EVAL_MEASURES]);

/* Gap of the inner lips in the middle, mm of the modelled speaker: positive = open, 0 = touching, negative
 * = pressed. */
static inline double eval_gap(const struct speech_pack *pack, const struct fap_frame *frame) {
    return -(frame->value[4] + frame->value[5]) * pack->fapu.mns / 1024;
}

/* A few words whose lips are plotted: those with the densest contacts. */

enum { STRETCH_WORDS = 6, STRETCH_STEPS = 500, STRETCH_ENGINES = 16 };

/* Chosen words; begins zeroed. */
struct stretch_choice {
    size_t sentence, first, count; /* words [first, first + count) of that sentence */
    size_t contacts;
};

struct stretch_phone {
    char label[PHONE_NAME_BYTES]; /* IPA; "" = pause */
    double start, end;            /* s from the start of the stretch */
};

struct stretch_span {
    double begin, end;
    bool teeth;
};

/* Data to plot at one speech rate. */
struct stretch {
    double seconds;
    struct stretch_phone *phones;
    size_t phone_count, phone_cap;
    struct stretch_span *spans; /* contacts */
    size_t span_count, span_cap;
    float gaps[STRETCH_ENGINES][STRETCH_STEPS + 1]; /* mm, equidistant in time */
};

/* Chooses words of this sentence if they are better than the current ones; true when it did. */
bool stretch_choose(struct stretch_choice *choice, const struct speech_pack *pack,
                    const struct sentence_audio *u, size_t number);

/* Fills the stretch for one engine < STRETCH_ENGINES; in->audio is the chosen sentence at any rate. */
void stretch_take(struct stretch *s, const struct stretch_choice *choice, const struct eval_input *in,
                  size_t engine);
void stretch_free(struct stretch *s);

#endif
