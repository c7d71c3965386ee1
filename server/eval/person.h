/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A person's mouth as it was recorded, beside what engines make of the same phones and times. */
#ifndef FACCIA_EVAL_PERSON_H
#define FACCIA_EVAL_PERSON_H

#include "server/eval/curve_match.h"
#include "server/eval/eval.h"
#include "server/fit/measured_speech.h"

/* What is compared: the parameters, and the aperture of the lips, LI + LS. */
enum { PERSON_APERTURE = PARAM_COUNT, PERSON_MEASURES };
extern const char *const person_measures[PERSON_MEASURES];

bool person_has(const struct measured_speech *person, int measure);

/* mm at t, between two frames on the straight line, beyond the first and the last as there. */
double person_at(const struct measured_speech *person, int measure, double t);

/* From the start of the first phone to the end of the last one, without the pauses before and behind. */
void person_speech(const struct measured_speech *person, double *start, double *end);

/* The phones as sentence audio without sound, for face_track_new: free with person_audio_free. */
struct sentence_audio *person_audio(const struct measured_speech *person);
void person_audio_free(struct sentence_audio *audio);

/* The same of a face. */
struct person_face {
    const struct speech_pack *pack;
    struct eval_face face;
    int measure;
};
double person_face_at(void *person_face, double t);

/* Another person who says the same, brought to the times of the first: the beginnings and ends of the phones
 * that both have (the longest common sequence) are laid on each other, with straight lines between. */
struct person_warp {
    const struct measured_speech *other;
    int measure;
    double (*anchors)[2]; /* time of the person, of the other; both rise */
    size_t count;
    size_t matched; /* phones that both have */
};
void person_warp_new(struct person_warp *warp, const struct measured_speech *person,
                     const struct measured_speech *other);
double person_warp_time(const struct person_warp *warp, double t);
double person_warp_at(void *person_warp, double t);
void person_warp_free(struct person_warp *warp);

/* The measure of the prediction over the person's frames. NULL predict: nothing. */
struct curve_match_shifted person_match(const struct measured_speech *person, int measure,
                                        double (*predict)(void *ctx, double t), void *ctx, double always);

#endif
