/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ARPAbet, the names that English corpora give to phones (ARPA Speech Understanding Project, 1971 to 1976),
 * with the additions of TIMIT, in either case. */
#ifndef FACCIA_RESEARCH_MEASURED_SPEECH_H
#define FACCIA_RESEARCH_MEASURED_SPEECH_H

#include "server/base/error.h"
#include "server/face/engines/phone_segments.h"
#include <stdbool.h>
#include <stdint.h>

/* IPA of a name, "" for a pause, and its stress (a digit after a vowel: 1 primary, 2 secondary) as 0 none,
 * 1 secondary, 2 primary. NULL: unknown name. */
const char *arpabet_ipa(const char *name, uint8_t *stress);

/* True for names of two or more letters, which are hardly IPA or SAMPA. */
bool arpabet_is_telling(const char *name);

/* A speaker's recordings, prepared for a fit: rest subtracted, repetitions aligned in time and averaged
 * (Leone, "LUCIA-WebGL", chapter 3.4.2). */

/* Frame rate of averaged recordings, as in the thesis. */
#define RECORDING_FPS 100

/* Durations of repetitions (between pauses) differ at most by this factor: averaging slow and fast speech
 * would hide the effect of the rate on the lips. */
#define RECORDING_SAME_RATE 1.25

struct recorded_phone {
    char ipa[PHONE_NAME_BYTES]; /* "" = pause */
    double start, end;          /* s */
    uint8_t stress;             /* 0 none, 1 secondary, 2 primary */
};

struct measured_speech {
    struct recorded_phone *phones;
    size_t phone_count, phone_cap;
    double *times; /* s, strictly ascending */
    size_t frame_count;
    double *curves[PARAM_COUNT]; /* mm at times; NULL = not recorded */
    double *spread[PARAM_COUNT]; /* mm: standard deviation of averaged recordings; NULL = a single one */
    bool *unseen[PARAM_COUNT];   /* frames to ignore because they are estimated; NULL = none */
    size_t repetitions;          /* number of averaged recordings; 1 = as recorded */
};

void measured_speech_free(struct measured_speech *r);
void measured_speech_free_all(struct measured_speech *list, size_t count);

/* Appends a phone; a gap before it is a pause. -1 (code "bad-curves") when it ends before it starts or
 * overlaps the previous one. */
int measured_speech_add(struct measured_speech *r, const struct recorded_phone *phone, struct error *e);

/* -1 (code "bad-curves") when nothing is spoken or the curves do not cover the speech. */
int measured_speech_check(const struct measured_speech *r, struct error *e);

/* Makes the curves relative to rest: the mean over the resting parts of the first and last pause. -1 (code
 * "bad-curves") without surrounding pauses, or if the curves do not cover the speech and a part of both
 * pauses. */
int measured_speech_subtract_rest(struct measured_speech *r, const struct speech_rest *rest, struct error *e);

/* Recordings of the same phones at about the same rate (RECORDING_SAME_RATE) become one, in the order of
 * their first: its phones have their mean lengths, and each repetition's curves, stretched linearly between
 * the boundaries of the phones and resampled by cubic splines, are averaged. A curve is kept when all
 * repetitions have it, a frame counts when it does in all of them. All begin at 0 s. Returns a list for
 * measured_speech_free_all. */
struct measured_speech *measured_speech_average_all(const struct measured_speech *list, size_t count,
                                                    size_t *out_count);

/* The same phones as the face engine sees them. */
void measured_speech_segments(const struct speech_pack *pack, const struct measured_speech *r,
                              void (*warn)(void *ctx, const char *message), void *ctx,
                              struct phone_segments *out);

#endif
