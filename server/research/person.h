/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Similarity of two curves. */
#ifndef FACCIA_RESEARCH_PERSON_H
#define FACCIA_RESEARCH_PERSON_H

#include "server/research/eval.h"
#include "server/research/measured_speech.h"
#include <stddef.h>

/* NAN where undefined: a constant curve has no correlation. */
struct curve_match {
    size_t count;
    double correlation; /* Pearson's */
    double offset_rms;  /* rms of y - f after removing a constant offset, in the curves' unit */
    double affine_rms;  /* after also scaling f: sd(y) sqrt(1 - correlation^2) */
};

/* y: measured, f: predicted. */
struct curve_match curve_match(const double *y, const double *f, size_t count);

/* Range of shifts to try, s; positive = later prediction. */
#define CURVE_SHIFT_MOST 0.06
#define CURVE_SHIFT_STEP 0.005

/* The match without a shift, and with the shift of the highest correlation. */
struct curve_match_shifted {
    struct curve_match as_is, best;
    double shift; /* of best, s */
};

/* predict(ctx, t): prediction at t s. `always` (s) is added to every shift. */
struct curve_match_shifted curve_match_shifted(const double *times, const double *y, size_t count,
                                               double (*predict)(void *ctx, double t), void *ctx,
                                               double always);

/* A recorded speaker's mouth, compared with engines given the same phones and times. */

/* Measures: the parameters, and the aperture of the lips, LI + LS. */
enum { PERSON_APERTURE = PARAM_COUNT, PERSON_MEASURES };
extern const char *const person_measures[PERSON_MEASURES];

bool person_has(const struct measured_speech *person, int measure);

/* mm at t, interpolated linearly between frames, constant outside. */
double person_at(const struct measured_speech *person, int measure, double t);

/* From the start of the first phone to the end of the last, without surrounding pauses. */
void person_speech(const struct measured_speech *person, double *start, double *end);

/* The phones as sentence audio without sound, for face_track_new; free it with person_audio_free. */
struct sentence_audio *person_audio(const struct measured_speech *person);
void person_audio_free(struct sentence_audio *audio);

/* The same measures of a face. */
struct person_face {
    const struct speech_pack *pack;
    struct eval_face face;
    int measure;
};
double person_face_at(void *person_face, double t);

/* Maps times to another speaker of the same words: boundaries of phones that both have (the longest common
 * sequence) coincide, with linear interpolation between them. */
struct person_warp {
    const struct measured_speech *other;
    int measure;
    double (*anchors)[2]; /* time of the speaker, of the other; both ascending */
    size_t count;
    size_t matched; /* number of common phones */
};
void person_warp_new(struct person_warp *warp, const struct measured_speech *person,
                     const struct measured_speech *other);
double person_warp_time(const struct person_warp *warp, double t);
double person_warp_at(void *person_warp, double t);
void person_warp_free(struct person_warp *warp);

/* Matches a prediction over the speaker's frames. NULL predict: no result. */
struct curve_match_shifted person_match(const struct measured_speech *person, int measure,
                                        double (*predict)(void *ctx, double t), void *ctx, double always);

/* A lip reader trained on people: a nearest neighbour over recorded lips and jaws, applied to an engine's
 * mouth. Unlike one trained on the engine itself, it does not reward shapes that are merely distinct: they
 * have to be human. */

/* A mouth with its phones, of a person or an engine. */
struct person_mouth {
    const struct speech_pack *pack;
    const struct phone_segments *segments;
    double (*at)(void *ctx, int measure, double t);
    void *ctx;
};

/* Adds a sample for each phone: the measures in `use` at its middle and its neighbours' middles,
 * normalised by this mouth's mean and standard deviation, so that marker positions and mouth size do not
 * count; its class is its viseme group. */
void person_reader_add(struct lip_reader *reader, int half, const struct person_mouth *mouth,
                       const bool use[PERSON_MEASURES]);

#endif
